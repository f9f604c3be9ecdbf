//! An experiment in text form.

use std::fmt;
use std::str::FromStr;

use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, Shape};

/// Time of logging before and after an excitation, s.
const BEFORE_S: f64 = 0.25;
const AFTER_S: f64 = 0.25;
/// Default duration of a step, s.
const STEP_S: f32 = 1.0;
/// Default duration of other excitations, s.
const SIGNAL_S: f32 = 4.0;

/// An excitation of the firmware and its mode. The amplitude is N m at the motor in torque mode and degrees in position
/// mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Torque or position mode.
    pub mode: Mode,
    /// The excitation, with the amplitude in the unit of the mode.
    pub excitation: Excitation,
}

/// The text does not describe an experiment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "'{0}' is no experiment: write SHAPE:AMPLITUDE,HZ,SECONDS as in multisine:0.0036,2,4 (N m at the motor), \
     step:10 (degrees), position:sine:15,0.5,8 (degrees), chirp:0.002,0.5,8,10"
)]
pub struct PlanError(String);

impl Plan {
    /// The same experiment with another amplitude.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        let mut plan = self.clone();
        plan.excitation.amplitude *= factor;
        plan
    }

    /// Duration of the excitation, s.
    pub fn signal_s(&self) -> f64 {
        f64::from(self.excitation.duration_s)
    }

    /// Time of logging after the excitation, s. It includes the return from a step.
    pub fn after_s(&self) -> f64 {
        match self.excitation.shape {
            Shape::Step => self.signal_s(),
            _ => AFTER_S,
        }
    }

    /// Whole time of logging, s.
    pub fn whole_s(&self) -> f64 {
        BEFORE_S + self.signal_s() + self.after_s()
    }

    /// Time of logging before the excitation, s.
    pub fn before_s(&self) -> f64 {
        BEFORE_S
    }

    /// Name of the excitation's shape.
    pub fn shape(&self) -> &'static str {
        Shape::NAMED
            .iter()
            .find(|(_, shape)| *shape == self.excitation.shape)
            .map_or("", |(name, _)| name)
    }

    /// The console command that starts it.
    pub fn start_line(&self) -> String {
        let Excitation {
            shape,
            amplitude,
            frequency_hz,
            end_frequency_hz,
            duration_s,
            ..
        } = self.excitation;
        let name = self.shape();
        match shape {
            Shape::Step | Shape::Ramp => format!("start {name} {amplitude} {duration_s}"),
            Shape::Chirp => {
                format!("start {name} {amplitude} {frequency_hz} {end_frequency_hz} {duration_s}")
            }
            _ => format!("start {name} {amplitude} {frequency_hz} {duration_s}"),
        }
    }

    /// Name of the mode in the console.
    pub fn mode_name(&self) -> &'static str {
        if self.mode == Mode::Torque {
            "torque"
        } else {
            "position"
        }
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = self.start_line();
        let numbers: Vec<_> = numbers.split(' ').skip(2).collect();
        write!(
            f,
            "{}:{}:{}",
            self.mode_name(),
            self.shape(),
            numbers.join(",")
        )
    }
}

impl FromStr for Plan {
    type Err = PlanError;

    fn from_str(text: &str) -> Result<Self, PlanError> {
        let wrong = || PlanError(text.to_owned());
        let mut parts: Vec<_> = text.split(':').collect();
        let mode = match parts.first() {
            Some(&"torque") => Some(Mode::Torque),
            Some(&"position") => Some(Mode::Position),
            _ => None,
        };
        if mode.is_some() {
            parts.remove(0);
        }
        let [name, numbers] = parts[..] else {
            return Err(wrong());
        };
        let (_, shape) = Shape::NAMED
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(wrong)?;
        let numbers: Vec<f32> = numbers
            .split(',')
            .map(|number| number.trim().parse().ok().filter(|n: &f32| n.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(wrong)?;
        let at = |index: usize| numbers.get(index).copied();
        let mut excitation = Excitation {
            shape: *shape,
            ..Excitation::step(at(0).ok_or_else(wrong)?)
        };
        let (used, duration_s) = match shape {
            Shape::Step => (2, at(1).unwrap_or(STEP_S)),
            Shape::Ramp => (2, at(1).ok_or_else(wrong)?),
            Shape::Chirp => {
                excitation.frequency_hz = at(1).ok_or_else(wrong)?;
                excitation.end_frequency_hz = at(2).ok_or_else(wrong)?;
                (4, at(3).ok_or_else(wrong)?)
            }
            Shape::Sine | Shape::Square | Shape::Triangle | Shape::Multisine => {
                excitation.frequency_hz = at(1).ok_or_else(wrong)?;
                (3, at(2).unwrap_or(SIGNAL_S))
            }
        };
        if numbers.len() > used || duration_s <= 0.0 {
            return Err(wrong());
        }
        excitation.duration_s = duration_s;
        let mode = mode.unwrap_or(match shape {
            Shape::Step => Mode::Position,
            _ => Mode::Torque,
        });
        Ok(Self { mode, excitation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn experiments_are_read_and_written() {
        for (text, written, line) in [
            ("step:10", "position:step:10,1", "start step 10 1"),
            (
                "multisine:0.0036,2,4",
                "torque:multisine:0.0036,2,4",
                "start multisine 0.0036 2 4",
            ),
            (
                "position:sine:15,0.5",
                "position:sine:15,0.5,4",
                "start sine 15 0.5 4",
            ),
            (
                "chirp:0.002,0.5,8,10",
                "torque:chirp:0.002,0.5,8,10",
                "start chirp 0.002 0.5 8 10",
            ),
            ("ramp:0.003,2", "torque:ramp:0.003,2", "start ramp 0.003 2"),
        ] {
            let plan: Plan = text.parse().unwrap();
            assert_eq!(plan.to_string(), written);
            assert_eq!(plan.start_line(), line);
            assert_eq!(written.parse(), Ok(plan));
        }
    }

    #[test]
    fn invalid_experiments_are_refused() {
        for text in [
            "",
            "step",
            "step:",
            "step:ten",
            "hop:1",
            "sine:1",
            "sine:1,2,3,4",
            "step:10,-1",
            "sine:nan,1,1",
            "torque:position:step:1",
        ] {
            assert!(text.parse::<Plan>().is_err(), "{text}");
        }
    }
}
