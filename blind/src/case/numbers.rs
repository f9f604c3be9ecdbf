//! Stated numbers that are off, and what is stated about how well they are known.

use recording::{Model, Tolerance};

use super::alike;
use super::stated::USUAL_TOLERANCES;
use crate::draw::Draw;

/// A stated number is off by at most this share of its true value.
pub(super) const MOST_OFF: f64 = 0.3;
/// One that is the dominant cause is off by at least this share.
const DOMINANT_OFF: f64 = 0.15;
/// Share of the recordings on which only `ratio` is off: with others it would cancel them, for it scales them all.
const RATIO_ALONE: f64 = 0.2;
/// Share of the other numbers that are off.
const OFF: f64 = 0.5;
/// Share of the recordings that state tolerances, and of a number's error over its tolerance: of a plausible statement.
const STATED: f64 = 0.5;
const ERROR_OVER_TOLERANCE: [f64; 2] = [0.5, 2.0];
const LEAST_TOLERANCE: f64 = 0.005;

/// The numbers of a model that can be off, each with the name of the effect that it is.
const NUMBERS: [(&str, &str); 6] = [
    ("inertia", "inertia"),
    ("viscous", "viscous"),
    ("coulomb", "coulomb"),
    ("gravity", "gravity"),
    ("stiffness", "spring"),
    ("ratio", "torque_gain"),
];

/// The name of the effect that a wrong `number` is.
pub(crate) fn effect_of(number: &str) -> Option<&'static str> {
    let found = NUMBERS.iter().find(|(name, _)| *name == number);
    found.map(|(_, effect)| *effect)
}

/// One number that is off.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffNumber {
    pub number: &'static str,
    pub effect: &'static str,
    /// Stated over true value, less 1.
    pub relative: f64,
}

impl OffNumber {
    /// States the number wrong in `model`.
    pub fn misstate(&self, model: &mut Model) {
        if let Some(value) = model.get(self.number) {
            let _ = model.set(self.number, value * (1.0 + self.relative));
        }
    }
}

/// Those that `model` has.
fn of(model: &Model) -> impl Iterator<Item = (&'static str, &'static str)> {
    let there = |name: &str| model.get(name).is_some_and(|value| value != 0.0);
    NUMBERS.into_iter().filter(move |(name, _)| there(name))
}

/// The number that is the dominant cause; `None` if each of them is hidden already.
pub(super) fn dominant(draw: &mut Draw, model: &Model, hidden: &[&str]) -> Option<OffNumber> {
    let free: Vec<_> = of(model)
        .filter(|(_, effect)| !hidden.iter().any(|name| alike(name, effect)))
        .collect();
    if free.is_empty() {
        return None;
    }
    let (number, effect) = draw.pick(&free);
    let relative = draw.sign() * draw.uniform(DOMINANT_OFF, MOST_OFF);
    Some(OffNumber {
        number,
        effect,
        relative,
    })
}

/// Numbers that are off beside the `dominant` cause: none that is alike to it or hidden itself.
pub(super) fn beside(
    draw: &mut Draw,
    model: &Model,
    dominant: &str,
    hidden: &[&str],
) -> Vec<OffNumber> {
    let ratio_alone = draw.chance(RATIO_ALONE);
    of(model)
        .filter_map(|(number, effect)| {
            let is_off = match number {
                "ratio" => ratio_alone,
                _ => !ratio_alone && draw.chance(OFF),
            };
            let relative = draw.uniform(-MOST_OFF, MOST_OFF);
            let free = !hidden.contains(&effect) && !alike(dominant, effect);
            (is_off && free).then_some(OffNumber {
                number,
                effect,
                relative,
            })
        })
        .collect()
}

/// What is stated about the numbers: of one that is off what its error makes plausible, of the others the usual. Some users
/// state nothing.
pub(super) fn tolerance(draw: &mut Draw, model: &Model, off: &[OffNumber]) -> Tolerance {
    let mut tolerance = Tolerance::default();
    let stated = draw.chance(STATED);
    for (name, low, high) in USUAL_TOLERANCES {
        let usual = draw.log_uniform(low, high);
        let [least, most] = ERROR_OVER_TOLERANCE;
        let over = draw.log_uniform(least, most);
        let is_off = off.iter().find(|off| off.number == name);
        let relative = is_off.map_or(usual, |off| {
            // Of the stated value, by the format.
            let error = (off.relative / (1.0 + off.relative)).abs();
            (error / over).max(LEAST_TOLERANCE)
        });
        if stated && of(model).any(|(number, _)| number == name) {
            tolerance.set(name, (relative * 1e4).round() / 1e4);
        }
    }
    tolerance
}
