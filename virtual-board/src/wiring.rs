//! What is wired to the chip: the simulated paddle, its motor behind the bridge, and its sensors.

use haptic_paddle::controller::{Duty, Measurement};
use haptic_paddle::sensing::hall::ADC_FULL_SCALE;
use haptic_paddle::settings::Settings;
use host_sim::paddle::{Command, Paddle, PaddleSetup};

/// Time that the paddle is carried at once, s: the firmware's control period. What the bridge does is averaged over it,
/// and sensors hold what they read at its end.
pub const STEP_S: f64 = 50e-6;

/// How the paddle is wired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wires {
    /// The motor's two wires are exchanged.
    pub motor_swapped: bool,
    /// The motor is not connected.
    pub motor_cut: bool,
    /// The encoder's two channels are exchanged.
    pub encoder_swapped: bool,
    /// The encoder is not connected.
    pub encoder_cut: bool,
    /// The Hall sensor's magnet is the other way round.
    pub hall_swapped: bool,
    /// The Hall sensor is not connected; its input is pulled to ground.
    pub hall_cut: bool,
}

/// A way to wire wrongly, by name.
pub type WireFault = (&'static str, fn(&mut Wires));

impl Wires {
    /// Changes by name.
    pub const NAMED: [WireFault; 6] = [
        ("motor-swapped", |wires| wires.motor_swapped = true),
        ("motor-cut", |wires| wires.motor_cut = true),
        ("encoder-swapped", |wires| wires.encoder_swapped = true),
        ("encoder-cut", |wires| wires.encoder_cut = true),
        ("hall-swapped", |wires| wires.hall_swapped = true),
        ("hall-cut", |wires| wires.hall_cut = true),
    ];

    /// Makes the change of this name. Returns whether there is one.
    pub fn change(&mut self, name: &str) -> bool {
        let known = Self::NAMED.iter().find(|(known, _)| *known == name);
        known.map(|(_, change)| change(self)).is_some()
    }
}

/// What the amplifier of the current does beside amplifying.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AmplifierFaults {
    /// It reads this much too high, A.
    pub offset_a: f64,
    /// More than that while the bridge is on, as the shunt then swings with the supply, A.
    pub common_mode_a: f64,
    /// More than that at power-on, A, which dies away with the time constant, s.
    pub warm_up_a: f64,
    /// Of the warm-up, s.
    pub warm_up_s: f64,
    /// Amplitude of a wander at 40 Hz, A.
    pub wander_a: f64,
    /// It stands still at this reading, counts.
    pub stuck_counts: Option<f64>,
}

impl AmplifierFaults {
    /// What it reads too high at time `time_s` since power-on, A.
    fn error_a(&self, time_s: f64, bridge_on: bool) -> f64 {
        const WANDER_HZ: f64 = 40.0;
        let common_mode_a = if bridge_on { self.common_mode_a } else { 0.0 };
        let warm_up_a = if self.warm_up_a == 0.0 {
            0.0
        } else {
            self.warm_up_a * (-time_s / self.warm_up_s).exp()
        };
        let wander_a = self.wander_a * (std::f64::consts::TAU * WANDER_HZ * time_s).sin();
        self.offset_a + common_mode_a + warm_up_a + wander_a
    }
}

/// What reaches the pins at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Counts that the encoder has moved by in the step.
    pub encoder_counts: i32,
    /// Hall voltage, counts of a converter of 12 bit.
    pub hall_counts: u16,
    /// Mean current of the step, counts.
    pub current_counts: f64,
}

/// The paddle, wired.
#[derive(Debug, Clone)]
pub struct Wiring {
    /// Changes of the wires.
    pub wires: Wires,
    /// What the amplifier of the current does.
    pub amplifier: AmplifierFaults,
    paddle: Paddle,
    torque_constant_nm_per_a: f64,
    torque_limit_nm: f64,
    encoder_count: u32,
}

impl Wiring {
    /// The paddle of `setup` at rest. Of `settings` it takes what the firmware's defaults say of the sensors.
    pub fn new(setup: &PaddleSetup, settings: &Settings, wires: Wires) -> Self {
        Self {
            wires,
            amplifier: AmplifierFaults::default(),
            paddle: Paddle::new(setup, settings, STEP_S),
            torque_constant_nm_per_a: f64::from(settings.motor.torque_constant_nm_per_a),
            torque_limit_nm: f64::from(settings.motor.torque_limit_nm),
            encoder_count: setup.encoder_count,
        }
    }

    /// Carries it over a step, driven by a share of the supply from -1 to 1, or by nothing.
    pub fn step(&mut self, duty: Option<f64>) -> Sensed {
        match duty.filter(|_| !self.wires.motor_cut) {
            Some(duty) => {
                let duty = if self.wires.motor_swapped {
                    -duty
                } else {
                    duty
                };
                self.paddle.advance(Command {
                    duty: Duty(duty as f32),
                    torque_nm: self.told_nm() as f32,
                });
            }
            None => self.paddle.coast(),
        }
        let Measurement {
            encoder_count,
            hall_adc,
            current_adc,
        } = self.paddle.measure();
        let moved = encoder_count.wrapping_sub(self.encoder_count) as i32;
        self.encoder_count = encoder_count;
        Sensed {
            encoder_counts: match self.wires {
                Wires {
                    encoder_cut: true, ..
                } => 0,
                Wires {
                    encoder_swapped: true,
                    ..
                } => -moved,
                _ => moved,
            },
            hall_counts: match self.wires {
                Wires { hall_cut: true, .. } => 0,
                Wires {
                    hall_swapped: true, ..
                } => ADC_FULL_SCALE - hall_adc,
                _ => hall_adc,
            },
            current_counts: self.current_counts(f64::from(current_adc), duty.is_some()),
        }
    }

    /// What the amplifier makes of what an ideal one would read.
    fn current_counts(&self, ideal: f64, bridge_on: bool) -> f64 {
        let ideal = if self.wires.motor_swapped {
            // The shunt sits at the bridge, before the wires.
            2.0 * IDLE_COUNTS - ideal
        } else {
            ideal
        };
        let error_a = self.amplifier.error_a(self.paddle.time_s(), bridge_on);
        let counts = self
            .amplifier
            .stuck_counts
            .unwrap_or(ideal + error_a * COUNTS_PER_A);
        counts.clamp(0.0, f64::from(ADC_FULL_SCALE))
    }

    /// What the motor was told is known to the firmware alone; the bounds of the drive go by what it last made, within
    /// the firmware's own limit.
    fn told_nm(&self) -> f64 {
        let made_nm = self.torque_nm();
        made_nm.clamp(-self.torque_limit_nm, self.torque_limit_nm)
    }

    /// Mean torque of the motor over the last step, N m.
    pub fn torque_nm(&self) -> f64 {
        self.paddle.current_a() * self.torque_constant_nm_per_a
    }

    /// The paddle.
    pub fn paddle(&self) -> &Paddle {
        &self.paddle
    }
}

/// What the amplifier of the current reads without a current, counts.
const IDLE_COUNTS: f64 = 2048.0;
/// 25 mΩ, a gain of 30, and 2.5 V in 4096 counts.
const COUNTS_PER_A: f64 = 0.025 * 30.0 * 4096.0 / 2.5;
