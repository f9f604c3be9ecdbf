//! All causes of a messy case, and their sizes: each is made as large as its role wants, by simulation with and without it.

use recording::Model;

use super::GAP_OVER_FLOOR;
use super::bench::{Bench, Measured};
use super::messy::SMALL_CAUSES;
use super::numbers::{MOST_OFF, OffNumber};
use super::secret::Secret;
use crate::prediction::{self, HiddenStates};
use crate::reality::Reality;
use crate::scenario::{Plan, Scale};
use crate::session::Log;

/// The rms change of the prediction that a small cause makes, over that of the dominant one.
pub const SMALL_SHARE: [f64; 2] = [0.05, 0.25];
/// A number that is off beside the dominant cause changes the prediction by at most this share of what that one does.
const MOST_NUMBER_SHARE: f64 = 0.5;
/// Rounds of adjustments; after so many, causes that stay too small or too large are left out.
const ROUNDS: usize = 12;
const ROUNDS_WITH_ALL: usize = 7;

/// One cause of the gap.
#[derive(Clone, Debug)]
pub(super) enum Source {
    Hidden(Secret),
    Number(OffNumber),
}

/// A cause, and how large it should be.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub cause: Source,
    pub role: Role,
}

/// How large a cause should be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Role {
    /// This many floors.
    Dominant(f64),
    /// This share of the dominant one.
    Small(f64),
    /// At most half the dominant one.
    Number,
}

impl Part {
    /// Its name, or that of the effect which a wrong number is.
    pub fn name(&self) -> &'static str {
        match &self.cause {
            Source::Hidden(secret) => secret.name(),
            Source::Number(off) => off.effect,
        }
    }

    fn is_small(&self) -> bool {
        matches!(self.role, Role::Small(_))
    }

    /// Makes the cause larger or smaller; `false` if it is at the end of its range.
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
    /// The device, but for the cause `without`: one that is hidden is not there, a number is as it is stated.
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
            let there = Some(k) != without;
            match &part.cause {
                Source::Hidden(secret) if there => Some(secret),
                _ => None,
            }
        });
        // Coulomb friction sets the level that other effects of friction start from.
        let (levels, others): (Vec<_>, Vec<_>) =
            hidden.partition(|secret| secret.name() == "coulomb");
        for secret in levels.into_iter().chain(others) {
            secret.apply(&mut reality, scale);
        }
        reality
    }

    /// The model as it is stated.
    pub fn nominal(&self, true_model: &Model) -> Model {
        let mut model = *true_model;
        for off in self.off() {
            off.misstate(&mut model);
        }
        model
    }

    /// The numbers that are off.
    pub fn off(&self) -> impl Iterator<Item = &OffNumber> {
        self.0.iter().filter_map(|part| match &part.cause {
            Source::Number(off) => Some(off),
            Source::Hidden(_) => None,
        })
    }

    fn small(&self) -> usize {
        self.0.iter().filter(|part| part.is_small()).count()
    }

    /// The rms change of the prediction that each cause makes, in units of position.
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

/// A device that was carried out with all its causes at their sizes.
pub(super) struct Settled {
    pub reality: Reality,
    pub measured: Measured,
    /// See [`Parts::sizes`].
    pub sizes: Vec<f64>,
}

/// Adjusts all causes until each is as large as its role wants; `None` if they cannot be.
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
