//! The control core in closed loop with a simulated paddle, tick by tick.

use crate::device::Device;
use crate::motor::Motor;
use crate::paddle::{Actuator, Command, Paddle, PaddleSetup};
use haptic_paddle::controller::{ArmError, Controller, Mode, TickRate, ZeroError};
use haptic_paddle::settings::Settings;

/// Rates at which the core runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Period of the core's `step` by the board's clock, s.
    pub tick_s: f64,
    /// Ticks per period of the position loop.
    pub divider: u16,
    /// True duration of one second of the board's clock, s.
    pub true_s_per_s: f64,
}

impl Rates {
    /// Rates of the firmware: current loop at 20 kHz, position loop at 10 kHz.
    pub const FIRMWARE: Self = Self {
        tick_s: 50e-6,
        divider: 2,
        true_s_per_s: 1.0,
    };

    /// Rate of the lab's position loop: 350 µs.
    pub const LAB: Self = Self {
        tick_s: 350e-6,
        divider: 1,
        true_s_per_s: 1.0,
    };

    /// Rate of the lab's board. A nominal period of 350 µs takes 351 µs.
    pub const LAB_BOARD: Self = Self {
        true_s_per_s: 351.0 / 350.0,
        ..Self::LAB
    };

    /// Period of the position loop by the board's clock, s.
    pub fn position_tick_s(&self) -> f64 {
        self.tick_s * f64::from(self.divider.max(1))
    }
}

/// Settings of a closed loop.
#[derive(Clone, Debug)]
pub struct LoopSetup {
    /// Settings of the control core.
    pub settings: Settings,
    /// Rates of the control core.
    pub rates: Rates,
    /// The paddle that the core controls.
    pub paddle: PaddleSetup,
}

impl LoopSetup {
    /// `device` with an ideal actuator: the commanded torque acts exactly and at once. The rate is that of the lab.
    pub fn ideal(device: Device, settings: Settings) -> Self {
        Self {
            paddle: PaddleSetup::new(device, &settings),
            settings,
            rates: Rates::LAB,
        }
    }

    /// `device` driven through bridge and winding, at the rates of the firmware.
    pub fn firmware(device: Device, settings: Settings, motor: Motor) -> Self {
        let mut setup = Self::ideal(device, settings);
        setup.rates = Rates::FIRMWARE;
        setup.paddle.actuator = Actuator::Bridge(motor);
        setup.paddle.parts_per_tick = BRIDGE_PARTS_PER_TICK;
        setup
    }
}

/// Number of parts into which a tick of 50 µs is divided. Within a part the speed of the shaft changes linearly, to within
/// 1e-7° of the paddle.
const BRIDGE_PARTS_PER_TICK: u32 = 2;

/// State at the start of a tick, and the command during it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Time since the start of the session by the board's clock, s.
    pub time_s: f64,
    /// True position, rad.
    pub position_rad: f64,
    /// Command until the next tick.
    pub acting: Command,
}

/// A controller in closed loop with a paddle.
///
/// A duty that the core computes from the sample at one tick acts on the bridge from the next tick, as on the board. There,
/// conversion, computation and the preloaded compare register take the tick between. An ideal torque acts at once. A
/// controller that turns off disables the bridge at once, and the paddle coasts.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    controller: Controller,
    paddle: Paddle,
    rates: Rates,
    start_s: f64,
    ticks: u64,
    /// True if the computed command acts one tick later.
    delayed: bool,
    computed: Command,
}

impl ClosedLoop {
    /// A disarmed controller and a paddle at rest. The zero of the encoder is set at the true position.
    ///
    /// # Errors
    ///
    /// [`ZeroError`] if the paddle is outside the controller's travel.
    pub fn new(setup: &LoopSetup) -> Result<Self, ZeroError> {
        let rates = setup.rates;
        let rate = TickRate::new((1.0 / rates.tick_s) as f32, rates.divider);
        let mut controller = Controller::new(&setup.settings, rate);
        let true_tick_s = rates.tick_s * rates.true_s_per_s;
        let mut paddle = Paddle::new(&setup.paddle, &setup.settings, true_tick_s);
        // Runs one period of the position loop, so that the next tick starts a new one.
        for _ in 0..rates.divider.max(1) {
            controller.step(&paddle.measure());
        }
        controller.zero_at(setup.paddle.start_rad as f32)?;
        Ok(Self {
            controller,
            paddle,
            rates,
            start_s: setup.paddle.start_s,
            ticks: 0,
            delayed: matches!(setup.paddle.actuator, Actuator::Bridge(_)),
            computed: Command::default(),
        })
    }

    /// The same as [`Self::new`], with the controller armed in `mode`.
    ///
    /// # Errors
    ///
    /// [`LoopError`] if the controller refuses.
    pub fn armed(setup: &LoopSetup, mode: Mode) -> Result<Self, LoopError> {
        let mut closed_loop = Self::new(setup)?;
        closed_loop.controller.arm(mode)?;
        Ok(closed_loop)
    }

    /// Simulates one tick: reads the sensors, runs the core, and advances the paddle to the next tick.
    #[inline]
    pub fn tick(&mut self) -> Tick {
        let measurement = self.paddle.measure();
        let computed = Command {
            duty: self.controller.step(&measurement),
            torque_nm: self.controller.torque_command_nm(),
        };
        let released = self.delayed && self.controller.mode() == Mode::Off;
        let acting = match self.delayed {
            true if released => Command::default(),
            true => self.computed,
            false => computed,
        };
        self.computed = computed;
        let tick = Tick {
            time_s: self.time_s(),
            position_rad: self.paddle.position_rad(),
            acting,
        };
        if released {
            self.paddle.coast();
        } else {
            self.paddle.advance(acting);
        }
        self.ticks += 1;
        tick
    }

    /// Time of the next tick since the start of the session by the board's clock, s.
    pub fn time_s(&self) -> f64 {
        self.start_s + self.ticks as f64 * self.rates.tick_s
    }

    /// The control core.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The control core, for commands.
    pub fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// The paddle.
    pub fn paddle(&self) -> &Paddle {
        &self.paddle
    }

    /// Rates of the control core.
    pub fn rates(&self) -> Rates {
        self.rates
    }
}

/// Why a closed loop cannot start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoopError {
    /// The zero of the encoder cannot be set.
    #[error("start angle: {0}")]
    Zero(#[from] ZeroError),
    /// The controller refuses.
    #[error("{0}")]
    Arm(#[from] ArmError),
}
