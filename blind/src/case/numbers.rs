//! Draws wrong stated numbers and the tolerances that the manifest states for them.

use recording::{Model, Tolerance};

use super::alike;
use super::stated::USUAL_TOLERANCES;
use crate::draw::Draw;

/// Largest relative error of a stated number.
pub(super) const MOST_OFF: f64 = 0.3;
/// Least relative error of a stated number that is the dominant cause.
const DOMINANT_OFF: f64 = 0.15;
/// Probability that `ratio` is the only wrong number. It scales all torques, so it could cancel the errors of other numbers.
const RATIO_ALONE: f64 = 0.2;
/// Probability that any other number is wrong.
const OFF: f64 = 0.5;
/// Probability that a recording states tolerances.
const STATED: f64 = 0.5;
/// Least and largest error of a wrong number over its stated tolerance.
const ERROR_OVER_TOLERANCE: [f64; 2] = [0.5, 2.0];
const LEAST_TOLERANCE: f64 = 0.005;

/// The model numbers that can be wrong, each with the name of the effect that its error equals.
const NUMBERS: [(&str, &str); 6] = [
    ("inertia", "inertia"),
    ("viscous", "viscous"),
    ("coulomb", "coulomb"),
    ("gravity", "gravity"),
    ("stiffness", "spring"),
    ("ratio", "torque_gain"),
];

/// The name of the effect that an error of `number` equals.
pub(crate) fn effect_of(number: &str) -> Option<&'static str> {
    let found = NUMBERS.iter().find(|(name, _)| *name == number);
    found.map(|(_, effect)| *effect)
}

/// One stated number that is wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrongNumber {
    pub number: &'static str,
    pub effect: &'static str,
    /// Relative error: stated over true value, less 1.
    pub relative: f64,
}

impl WrongNumber {
    /// Writes the wrong value into `model`.
    pub fn misstate(&self, model: &mut Model) {
        if let Some(value) = model.get(self.number) {
            let _ = model.set(self.number, value * (1.0 + self.relative));
        }
    }
}

/// The numbers of [`NUMBERS`] that are not zero in `model`.
fn of(model: &Model) -> impl Iterator<Item = (&'static str, &'static str)> {
    let there = |name: &str| model.get(name).is_some_and(|value| value != 0.0);
    NUMBERS.into_iter().filter(move |(name, _)| there(name))
}

/// Draws the wrong number that is the dominant cause. Returns `None` if none can be separated from the hidden effects.
pub(super) fn dominant(draw: &mut Draw, model: &Model, hidden: &[&str]) -> Option<WrongNumber> {
    let free: Vec<_> = of(model)
        .filter(|(_, effect)| !hidden.iter().any(|name| alike(name, effect)))
        .collect();
    if free.is_empty() {
        return None;
    }
    let (number, effect) = draw.pick(&free);
    let relative = draw.sign() * draw.uniform(DOMINANT_OFF, MOST_OFF);
    Some(WrongNumber {
        number,
        effect,
        relative,
    })
}

/// Draws the wrong numbers of less weight. None of them is a hidden effect or inseparable from the dominant cause.
pub(super) fn minor(
    draw: &mut Draw,
    model: &Model,
    dominant: &str,
    hidden: &[&str],
) -> Vec<WrongNumber> {
    let ratio_alone = draw.chance(RATIO_ALONE);
    of(model)
        .filter_map(|(number, effect)| {
            let is_off = match number {
                "ratio" => ratio_alone,
                _ => !ratio_alone && draw.chance(OFF),
            };
            let relative = draw.uniform(-MOST_OFF, MOST_OFF);
            let free = !hidden.contains(&effect) && !alike(dominant, effect);
            (is_off && free).then_some(WrongNumber {
                number,
                effect,
                relative,
            })
        })
        .collect()
}

/// Draws the stated tolerances. The tolerance of a wrong number is of the order of its error. Other numbers have usual
/// tolerances. Some recordings state none.
pub(super) fn tolerance(draw: &mut Draw, model: &Model, off: &[WrongNumber]) -> Tolerance {
    let mut tolerance = Tolerance::default();
    let stated = draw.chance(STATED);
    for (name, low, high) in USUAL_TOLERANCES {
        let usual = draw.log_uniform(low, high);
        let [least, most] = ERROR_OVER_TOLERANCE;
        let over = draw.log_uniform(least, most);
        let is_off = off.iter().find(|off| off.number == name);
        let relative = is_off.map_or(usual, |off| {
            // The format states tolerances relative to the stated value.
            let error = (off.relative / (1.0 + off.relative)).abs();
            (error / over).max(LEAST_TOLERANCE)
        });
        if stated && of(model).any(|(number, _)| number == name) {
            tolerance.set(name, (relative * 1e4).round() / 1e4);
        }
    }
    tolerance
}
