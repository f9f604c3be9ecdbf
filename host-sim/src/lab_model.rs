//! The lab's own Simulink model of the paddle (report, figures 1, 2 and 5), including the two errors in its friction.
//!
//! ```text
//! J x'' = R s (T − F) − B x' − G sin x
//! F     = T₀ sign(x') where |x'| > 20 rad/s, else 0
//! s     = 1 in a step if, in the step before, |T| > T₀ and s = 0; else 0
//! ```
//!
//! 1. `s` was meant to store that the paddle has moved. It is fed back through a NOT, so that it falls one step after it
//!    rises. While |T| > T₀ the torque passes in every second step. Below T₀ it does not pass at all.
//! 2. Friction is off below a speed, which was meant to suppress the sign function at rest. This speed is 20 rad/s
//!    (1146°/s). The motions of the report stay far below it, so dry friction never acts.

use recording::Model;
use std::f64::consts::TAU;

/// The fixed step of its solver (fourth-order Runge-Kutta), s.
pub const STEP_S: f64 = 0.01;

/// Speed above which its dry friction acts, rad/s.
pub const FRICTION_FROM_RAD_S: f64 = 20.0;

/// Excitation of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabDrive {
    /// A sine torque.
    Sine {
        /// Amplitude, N m at the motor.
        amplitude_nm: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
    },
    /// A step of the setpoint at time 0. The paddle hangs at 0 before.
    Step {
        /// New setpoint, rad.
        target_rad: f64,
        /// The regulator.
        pid: LabPid,
    },
}

/// Simulink's continuous parallel PID controller of the error in degrees, with the torque at the motor as output: `P + I/s +
/// D N s / (s + N)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabPid {
    /// P, N m per degree.
    pub p: f64,
    /// I, N m per degree and second.
    pub i: f64,
    /// D, N m s per degree.
    pub d: f64,
}

/// N of the derivative filter, 1/s. It is Simulink's default.
const DERIVATIVE_FILTER_PER_S: f64 = 100.0;

/// One step of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabSample {
    /// Time at the start of the step, s.
    pub time_s: f64,
    /// Position at the start of the step, rad.
    pub position_rad: f64,
    /// Velocity at the start of the step, rad/s.
    pub velocity_rad_s: f64,
    /// Mean commanded torque over the step, N m at the motor.
    pub command_nm: f64,
    /// Mean torque that the model lets through, minus friction, over the step, N m at the motor.
    pub motor_nm: f64,
}

/// Position, velocity, integral of the error in degrees, and state of the derivative filter.
type State = [f64; 4];

/// The model with its state.
#[derive(Clone, Copy, Debug)]
pub struct LabModel {
    model: Model,
    drive: LabDrive,
    state: State,
    steps: u64,
    /// True if the torque passes in this step.
    passing: bool,
}

/// Torques at one instant.
struct Instant {
    command_nm: f64,
    motor_nm: f64,
    rate: State,
}

impl LabModel {
    /// The model at rest at 0. It uses inertia, viscous friction, gravity, ratio and dry friction of `model`.
    pub fn at_rest(model: Model, drive: LabDrive) -> Self {
        Self {
            model,
            drive,
            state: [0.0; 4],
            steps: 0,
            passing: false,
        }
    }

    /// Simulates `seconds` and returns all samples.
    pub fn run(mut self, seconds: f64) -> Vec<LabSample> {
        (0..(seconds / STEP_S).round() as u64)
            .map(|_| self.step())
            .collect()
    }

    /// Simulates one step.
    pub fn step(&mut self) -> LabSample {
        let time_s = self.steps as f64 * STEP_S;
        let at = |after_s: f64, from: &State, rate: &State| {
            let state = std::array::from_fn(|i| from[i] + after_s * rate[i]);
            self.instant(time_s + after_s, &state)
        };
        let half_s = 0.5 * STEP_S;
        let first = self.instant(time_s, &self.state);
        let second = at(half_s, &self.state, &first.rate);
        let third = at(half_s, &self.state, &second.rate);
        let fourth = at(STEP_S, &self.state, &third.rate);
        let mean = |of: &dyn Fn(&Instant) -> f64| {
            (of(&first) + 2.0 * (of(&second) + of(&third)) + of(&fourth)) / 6.0
        };
        let sample = LabSample {
            time_s,
            position_rad: self.state[0],
            velocity_rad_s: self.state[1],
            command_nm: mean(&|instant| instant.command_nm),
            motor_nm: mean(&|instant| instant.motor_nm),
        };
        let rate: State = std::array::from_fn(|i| mean(&|instant| instant.rate[i]));
        for (value, rate) in self.state.iter_mut().zip(rate) {
            *value += STEP_S * rate;
        }
        self.passing = first.command_nm.abs() > self.dry_friction_nm() && !self.passing;
        self.steps += 1;
        sample
    }

    /// T₀, N m at the motor.
    fn dry_friction_nm(&self) -> f64 {
        self.model.coulomb / self.model.ratio
    }

    fn instant(&self, time_s: f64, &[position, velocity, integral, filtered]: &State) -> Instant {
        let (command_nm, error_deg, derivative) = match self.drive {
            LabDrive::Sine {
                amplitude_nm,
                frequency_hz,
            } => (amplitude_nm * (TAU * frequency_hz * time_s).sin(), 0.0, 0.0),
            LabDrive::Step { target_rad, pid } => {
                let error_deg = (target_rad - position).to_degrees();
                let derivative = DERIVATIVE_FILTER_PER_S * (pid.d * error_deg - filtered);
                let torque_nm = pid.p * error_deg + pid.i * integral + derivative;
                (torque_nm, error_deg, derivative)
            }
        };
        let friction_nm = if velocity.abs() > FRICTION_FROM_RAD_S {
            self.dry_friction_nm().copysign(velocity)
        } else {
            0.0
        };
        let motor_nm = if self.passing {
            command_nm - friction_nm
        } else {
            0.0
        };
        let model = &self.model;
        let torque_nm =
            model.ratio * motor_nm - model.viscous * velocity - model.gravity * position.sin();
        Instant {
            command_nm,
            motor_nm,
            rate: [velocity, torque_nm / model.inertia, error_deg, derivative],
        }
    }
}
