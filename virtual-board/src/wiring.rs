//! The paddle wired to the chip: simulated mechanics, the motor behind the bridge, and the sensors.

use haptic_paddle::controller::{Duty, Measurement};
use haptic_paddle::sensing::hall::ADC_FULL_SCALE;
use haptic_paddle::settings::Settings;
use host_sim::paddle::{Command, Paddle, PaddleSetup};

/// Time step of the paddle, s. It equals the control period of the firmware. The bridge output is averaged over a step. The
/// sensors are sampled at its end.
pub const STEP_S: f64 = 50e-6;

/// Wiring faults of the paddle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wires {
    /// If true, the two motor wires are exchanged.
    pub motor_swapped: bool,
    /// If true, the motor is not connected.
    pub motor_cut: bool,
    /// If true, the two encoder channels are exchanged.
    pub encoder_swapped: bool,
    /// If true, the encoder is not connected.
    pub encoder_cut: bool,
    /// If true, the magnet of the Hall sensor is reversed.
    pub hall_swapped: bool,
    /// If true, the Hall sensor is not connected and its input is pulled to ground.
    pub hall_cut: bool,
}

/// A wiring fault with its name.
pub type WireFault = (&'static str, fn(&mut Wires));

impl Wires {
    /// All wiring faults by name.
    pub const NAMED: [WireFault; 6] = [
        ("motor-swapped", |wires| wires.motor_swapped = true),
        ("motor-cut", |wires| wires.motor_cut = true),
        ("encoder-swapped", |wires| wires.encoder_swapped = true),
        ("encoder-cut", |wires| wires.encoder_cut = true),
        ("hall-swapped", |wires| wires.hall_swapped = true),
        ("hall-cut", |wires| wires.hall_cut = true),
    ];

    /// Applies the wiring fault of this name. Returns false if the name is unknown.
    pub fn change(&mut self, name: &str) -> bool {
        let known = Self::NAMED.iter().find(|(known, _)| *known == name);
        known.map(|(_, change)| change(self)).is_some()
    }
}

/// Errors of the current amplifier.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AmplifierFaults {
    /// Constant offset, A.
    pub offset_a: f64,
    /// Additional offset while the bridge is on, A. The common-mode voltage of the shunt then follows the supply.
    pub common_mode_a: f64,
    /// Additional offset at power-on, A. It decays with the time constant `warm_up_s`.
    pub warm_up_a: f64,
    /// Time constant of the warm-up, s.
    pub warm_up_s: f64,
    /// Amplitude of a sinusoidal error at 40 Hz, A.
    pub wander_a: f64,
    /// If set, the reading is stuck at this value, counts.
    pub stuck_counts: Option<f64>,
}

impl AmplifierFaults {
    /// Error of the reading at time `time_s` since power-on, A.
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

/// Sensor signals at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Change of the encoder count in the step.
    pub encoder_counts: i32,
    /// Hall voltage in counts of a 12-bit converter.
    pub hall_counts: u16,
    /// Mean current of the step, counts.
    pub current_counts: f64,
}

/// The wired paddle.
#[derive(Debug, Clone)]
pub struct Wiring {
    /// Wiring faults.
    pub wires: Wires,
    /// Errors of the current amplifier.
    pub amplifier: AmplifierFaults,
    paddle: Paddle,
    torque_constant_nm_per_a: f64,
    torque_limit_nm: f64,
    encoder_count: u32,
}

impl Wiring {
    /// The paddle of `setup` at rest. `settings` sets the default properties of the sensors.
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

    /// Advances the paddle by one step. `duty` is the duty cycle of the bridge, -1 to 1, or `None` if its outputs are off.
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
                    torque_nm: self.estimated_command_nm() as f32,
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

    /// Reading of the amplifier. `ideal` is the reading without errors.
    fn current_counts(&self, ideal: f64, bridge_on: bool) -> f64 {
        let ideal = if self.wires.motor_swapped {
            // The shunt is at the bridge, before the motor wires.
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

    /// Only the firmware knows the commanded torque. The bounds of the drive therefore use the torque of the last step,
    /// limited to the firmware's torque limit, N m.
    fn estimated_command_nm(&self) -> f64 {
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

/// Reading of the current amplifier at zero current, counts.
const IDLE_COUNTS: f64 = 2048.0;
/// Gain of the current measurement: a shunt of 25 mΩ, an amplifier gain of 30, and 4096 counts for 2.5 V.
const COUNTS_PER_A: f64 = 0.025 * 30.0 * 4096.0 / 2.5;
