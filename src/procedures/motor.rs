//! Identification of the winding's resistance and inductance. The motor hums meanwhile.
//!
//! The excitation is a square wave of the torque at a sixteenth of the control rate, which the paddle does not follow. In a
//! control period of length T with a constant voltage u, the mean current m of the winding follows
//!
//! ```text
//! m[k] = a m[k-1] + b0 u[k-2] + b1 u[k-3] + e s[k],   a = exp(-R T / L),   b0 + b1 = (1 - a) / R
//! ```
//!
//! A duty acts during the whole period after the next update, and its mean current is measured one period later. s is the
//! sum of the currents so far. It is proportional to the speed of a freely turning rotor.

use core::fmt;

use super::fit::least_squares;
use super::winding::PHASES;
use super::{Finding, Outcome, ProcedureError};
use crate::console::Device;
use crate::decimal::Fixed;
use crate::excitation::{Excitation, Shape};
use crate::settings::Settings;

/// Torque of the square wave, N m at the motor. It needs 0.19 A, a third of the motor's continuous current.
const HUM_NM: f32 = 0.010;
/// Settling time before the measurement, s.
const SETTLE_S: f32 = 0.1;
/// Number of periods of the square wave over which means are taken: 0.8 s.
const PERIODS: u32 = 1000;
/// Time limit of the measurement, s.
const PATIENCE_S: f32 = 3.0;

/// The result of the procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorFinding {
    /// Resistance of the winding, ohm.
    pub resistance_ohm: f32,
    /// Inductance of the winding, H.
    pub inductance_h: f32,
    /// Offset of the current amplifier, A, relative to half scale.
    pub offset_a: f32,
    /// Largest difference between measured and modelled current, relative to the largest current.
    pub misfit: f32,
}

impl fmt::Display for MotorFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "resistance {} ohm, inductance {} mH, offset of the current {} mA; the winding's model is off by {} % at most\r\n\
             motor.resistance and motor.inductance are set; save stores them",
            Fixed(self.resistance_ohm, 2),
            Fixed(self.inductance_h * 1e3, 3),
            Fixed(self.offset_a * 1e3, 1),
            Fixed(self.misfit * 1e2, 1)
        )
    }
}

/// The running procedure.
#[derive(Clone, Debug)]
pub struct MotorId {
    supply_v: f32,
    torque_limit_nm: f32,
    elapsed_s: f32,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Begin,
    Settle,
    Watch,
}

impl MotorId {
    /// Starts the procedure with the user's settings.
    pub fn new(users: &Settings) -> Self {
        Self {
            supply_v: users.motor.supply_v,
            torque_limit_nm: users.motor.torque_limit_nm,
            elapsed_s: 0.0,
            stage: Stage::Begin,
        }
    }

    /// See [`super::Procedure::advance`].
    #[inline(never)]
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        self.elapsed_s += elapsed_s;
        match self.stage {
            Stage::Begin => {
                let hum = |tick_s: f32| Excitation {
                    shape: Shape::Square,
                    frequency_hz: 1.0 / (PHASES as f32 * tick_s),
                    ..Excitation::step(HUM_NM.min(0.5 * self.torque_limit_nm))
                };
                if device.with(|c| c.start(&hum(c.tick_s()))).is_err() {
                    return Some(Err(ProcedureError::NoWinding));
                }
                self.next(Stage::Settle);
            }
            Stage::Settle if self.elapsed_s > SETTLE_S => {
                if device.telemetry(|t| t.winding.watch()).is_none() {
                    return Some(Err(ProcedureError::NoWinding));
                }
                self.next(Stage::Watch);
            }
            Stage::Settle => {}
            Stage::Watch => {
                let means = device.telemetry(|t| t.winding.means(PERIODS)).flatten();
                let (tick_s, offset_a) = device.with(|c| (c.tick_s(), c.current_offset_a()));
                if let Some([duty, current_a]) = means {
                    let voltage_v = duty.map(|duty| duty * self.supply_v);
                    let found = identify(&voltage_v, &current_a, tick_s, offset_a);
                    return Some(found.map(Finding::Motor).ok_or(ProcedureError::NoWinding));
                }
                if self.elapsed_s > PATIENCE_S {
                    return Some(Err(ProcedureError::TooLong));
                }
            }
        }
        None
    }

    fn next(&mut self, stage: Stage) {
        self.stage = stage;
        self.elapsed_s = 0.0;
    }
}

/// Fits the winding to one period of voltages, V, and mean currents, A. Returns `None` if the result is not plausible.
fn identify(
    voltage_v: &[f32; PHASES],
    current_a: &[f32; PHASES],
    tick_s: f32,
    offset_a: f32,
) -> Option<MotorFinding> {
    /// Largest accepted model error, relative to the largest current.
    const LARGEST_MISFIT: f32 = 0.05;
    let mean_a = current_a.iter().sum::<f32>() / PHASES as f32;
    let mean_v = voltage_v.iter().sum::<f32>() / PHASES as f32;
    let current = current_a.map(|current| current - mean_a);
    let voltage = voltage_v.map(|voltage| voltage - mean_v);
    let before = |values: &[f32; PHASES], periods: usize| {
        let mut values = *values;
        values.rotate_right(periods);
        values
    };
    // The speed of a freely turning rotor, up to a factor and an offset.
    let mut sum = 0.0;
    let speed = current.map(|current| {
        sum += current;
        sum
    });
    let mean_speed = speed.iter().sum::<f32>() / PHASES as f32;
    let speed = speed.map(|speed| speed - mean_speed);
    let columns = [
        before(&current, 1),
        before(&voltage, 2),
        before(&voltage, 3),
        before(&speed, 1),
    ];
    let solution = least_squares(columns, current)?;
    let [pole, first, second, _] = solution;
    let resistance_ohm = (1.0 - pole) / (first + second);
    let inductance_h = -resistance_ohm * tick_s / libm::logf(pole);
    let largest_a = current
        .iter()
        .fold(0.0, |largest: f32, a| largest.max(a.abs()));
    let worst_a = (0..PHASES).fold(0.0, |worst: f32, phase| {
        let of = |values: &[f32; PHASES]| values.get(phase).copied().unwrap_or_default();
        let model: f32 = columns
            .iter()
            .zip(solution)
            .map(|(column, share)| of(column) * share)
            .sum();
        worst.max((of(&current) - model).abs())
    });
    let misfit = worst_a / largest_a;
    (resistance_ohm > 0.0 && inductance_h > 0.0 && misfit < LARGEST_MISFIT).then_some(
        MotorFinding {
            resistance_ohm,
            inductance_h,
            offset_a,
            misfit,
        },
    )
}
