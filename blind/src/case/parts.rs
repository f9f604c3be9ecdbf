//! Adjusts the sizes of all causes of a messy case. The size of a cause is the rms difference between predictions with and
//! without it.

use recording::Model;

use super::GAP_OVER_FLOOR;
use super::bench::{Bench, Measured};
use super::messy::SMALL_CAUSES;
use super::numbers::{MOST_OFF, WrongNumber};
use super::secret::Secret;
use crate::prediction::{self, HiddenStates};
use crate::reality::Reality;
use crate::scenario::{Plan, Scale};
use crate::session::Log;

/// Least and largest size of a small cause over the size of the dominant one.
pub const SMALL_SHARE: [f64; 2] = [0.05, 0.25];
/// Largest size of a wrong number over the size of the dominant cause, if the number is not itself dominant.
const MOST_NUMBER_SHARE: f64 = 0.5;
/// Largest number of adjustment rounds.
const ROUNDS: usize = 12;
/// After this many rounds, small causes that are still out of range are dropped.
const ROUNDS_WITH_ALL: usize = 7;

/// One cause of the gap.
#[derive(Clone, Debug)]
pub(super) enum Source {
    Hidden(Secret),
    Number(WrongNumber),
}

/// A cause with its target size.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub cause: Source,
    pub role: Role,
}

/// The role of a cause, which sets its target size.
#[derive(Clone, Copy, Debug)]
pub(super) enum Role {
    /// The dominant cause, with its target size over the floor.
    Dominant(f64),
    /// A small cause, with its target size over the size of the dominant cause.
    Small(f64),
    /// A wrong stated number: at most [`MOST_NUMBER_SHARE`] of the size of the dominant cause.
    Number,
}

impl Part {
    /// The name of the effect. A wrong number has the name of the effect that its error equals.
    pub fn name(&self) -> &str {
        match &self.cause {
            Source::Hidden(secret) => secret.name(),
            Source::Number(off) => off.effect,
        }
    }

    fn is_small(&self) -> bool {
        matches!(self.role, Role::Small(_))
    }

    /// Multiplies the strength by `factor`, limited to its range. Returns `false` if it does not change.
    fn scale_by(&mut self, factor: f64) -> bool {
        match &mut self.cause {
            Source::Hidden(secret) => secret.scale_by(factor),
            Source::Number(off) => {
                let before = off.relative;
                off.relative = (before * factor).clamp(-MOST_OFF, MOST_OFF);
                (off.relative / before - 1.0).abs() > 0.01
            }
        }
    }
}

/// All causes of a case, the dominant one first.
#[derive(Clone, Debug)]
pub(super) struct Parts(pub Vec<Part>);

impl Parts {
    /// The device without the cause `without`: a hidden effect is left out, and a wrong number takes its stated value.
    fn reality(&self, true_model: &Model, scale: &Scale, without: Option<usize>) -> Reality {
        let mut model = *true_model;
        if let Some(Part {
            cause: Source::Number(off),
            ..
        }) = without.map(|k| &self.0[k])
        {
            off.misstate(&mut model);
        }
        let mut reality = Reality::plain(&model);
        let hidden = self.0.iter().enumerate().filter_map(|(k, part)| {
            let is_present = Some(k) != without;
            match &part.cause {
                Source::Hidden(secret) if is_present => Some(secret),
                _ => None,
            }
        });
        // Coulomb friction is applied first: other friction effects scale its level.
        let (levels, others): (Vec<_>, Vec<_>) =
            hidden.partition(|secret| secret.name() == "coulomb");
        for secret in levels.into_iter().chain(others) {
            secret.apply(&mut reality, scale);
        }
        reality
    }

    /// The model with the stated numbers, right and wrong.
    pub fn nominal(&self, true_model: &Model) -> Model {
        let mut model = *true_model;
        for off in self.off() {
            off.misstate(&mut model);
        }
        model
    }

    /// The wrong numbers among the causes.
    pub fn off(&self) -> impl Iterator<Item = &WrongNumber> {
        self.0.iter().filter_map(|part| match &part.cause {
            Source::Number(off) => Some(off),
            Source::Hidden(_) => None,
        })
    }

    fn small(&self) -> usize {
        self.0.iter().filter(|part| part.is_small()).count()
    }

    /// The size of each cause, in units of position.
    fn sizes(&self, bench: &Bench, scale: &Scale, logs: &[Log]) -> Vec<f64> {
        let predict = |without| {
            let reality = self.reality(&bench.plant.model, scale, without);
            let step_s = bench.prediction_step_s(&reality);
            let carried = HiddenStates::Carried;
            prediction::predict(&reality, logs, bench.restart, carried, step_s)
        };
        let whole = predict(None);
        let without = (0..self.0.len()).map(|k| predict(Some(k)));
        without
            .map(|without| prediction::difference(&whole, &without))
            .collect()
    }
}

/// The simulated device after all causes have reached their target sizes.
pub(super) struct Settled {
    pub reality: Reality,
    pub measured: Measured,
    /// See [`Parts::sizes`].
    pub sizes: Vec<f64>,
}

/// Adjusts all causes until each has a size that its role allows. Returns `None` if one cannot reach it.
pub(super) fn settle(
    bench: &mut Bench,
    parts: &mut Parts,
    plans: &[Plan],
    scale: &Scale,
) -> Option<Settled> {
    for round in 0..ROUNDS {
        bench.nominal = parts.nominal(&bench.plant.model);
        let reality = parts.reality(&bench.plant.model, scale, None);
        let Some(measured) = bench.measure(&reality, plans, scale) else {
            for part in &mut parts.0 {
                part.scale_by(0.5);
            }
            continue;
        };
        let sizes = parts.sizes(bench, scale, &measured.logs);
        if sizes.iter().any(|size| !size.is_finite()) {
            return None;
        }
        let floors = measured.reference.after;
        let mut outside = Vec::new();
        for (k, part) in parts.0.iter_mut().enumerate() {
            let share = sizes[k] / sizes[0];
            let (value, [low, high], aim) = match part.role {
                Role::Dominant(aim) => (sizes[0] / floors, GAP_OVER_FLOOR, aim),
                Role::Small(aim) => (share, SMALL_SHARE, aim),
                Role::Number => (share, [0.0, MOST_NUMBER_SHARE], 0.8 * MOST_NUMBER_SHARE),
            };
            if (low..=high).contains(&value) {
                continue;
            }
            outside.push(k);
            let moved = part.scale_by((aim / value).clamp(0.1, 10.0));
            if !moved && !part.is_small() {
                return None;
            }
        }
        if outside.is_empty() {
            let shows = measured.reference.before > GAP_OVER_FLOOR[0] * floors;
            return shows.then_some(Settled {
                reality,
                measured,
                sizes,
            });
        }
        if round >= ROUNDS_WITH_ALL && !outside.contains(&0) {
            let stays = |k: &usize| !outside.contains(k) || !parts.0[*k].is_small();
            let stay = (0..parts.0.len()).filter(stays);
            parts.0 = stay.map(|k| parts.0[k].clone()).collect();
            if parts.small() < SMALL_CAUSES[0] {
                return None;
            }
        }
    }
    None
}
