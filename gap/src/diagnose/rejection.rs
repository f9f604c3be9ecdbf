//! Reasons to reject a correction as a whole.

use super::unit_factor::UnitFactor;
use crate::model_free::ModelFree;
use crate::shrink::resampled;
use std::fmt;

/// Largest residual of a correction, with 97.5 % probability, as a share of the residual of the better model-free predictor. A model that
/// stands still or moves at constant velocity leaves all of it.
const MOST_OF_MODEL_FREE: f64 = 0.8;

/// Least lower bound of the shrink, with 97.5 % probability. It is negative because an effect in one or two windows is missing from many
/// resamplings, in which the other windows may become slightly worse.
const LEAST_SHRINK: f64 = -0.05;

/// The reason why a correction is rejected.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rejection {
    /// The correction is a factor between units.
    UnitMistake(UnitFactor),
    /// The input column is constant while the device is driven.
    FrozenInput,
    /// The correction predicts no better than a predictor without a model.
    NoBetterThanModelFree,
    /// The correction does not significantly shrink the gap on held-out data.
    ShrinksNothing,
}

impl Rejection {
    /// The reason to reject a correction with the sums of squared residuals `after`, if any. `shrink` is the lower bound of its shrink,
    /// with 97.5 % probability.
    pub(super) fn of(after: &[f64], model_free: &ModelFree, shrink: f64) -> Option<Self> {
        if shrink < LEAST_SHRINK {
            return Some(Self::ShrinksNothing);
        }
        let other = model_free.better();
        let [_, _, share] = resampled(after.len(), |sum| {
            (sum(after) / sum(other).max(f64::MIN_POSITIVE)).sqrt()
        });
        (share > MOST_OF_MODEL_FREE).then_some(Self::NoBetterThanModelFree)
    }
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnitMistake(factor) => write!(f, "{factor}"),
            Self::FrozenInput => f.write_str(
                "`input` is constant although the motion does not decay: the column is frozen, and the torque that drives the \
                 device is unknown",
            ),
            Self::NoBetterThanModelFree => f.write_str(
                "no effect explains the gap: the best correction predicts no better than a constant position or a constant \
                 velocity",
            ),
            Self::ShrinksNothing => f.write_str(
                "no effect explains the gap: the best correction does not significantly reduce it on held-out data",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_no_better_than_standing_still_is_rejected() {
        let squares: Vec<f64> = (0..40).map(|w| 1.0 + f64::from(w % 5)).collect();
        let model_free = ModelFree {
            standing: squares.clone(),
            coasting: squares.iter().map(|s| 3.0 * s).collect(),
        };
        let squares_with = |share: f64| {
            squares
                .iter()
                .map(|s| share * share * s)
                .collect::<Vec<_>>()
        };
        let rejected = |share, shrink| Rejection::of(&squares_with(share), &model_free, shrink);
        assert_eq!(rejected(1.0, 0.9), Some(Rejection::NoBetterThanModelFree));
        assert_eq!(rejected(0.5, 0.9), None);
        assert_eq!(rejected(0.5, -0.1), Some(Rejection::ShrinksNothing));
    }
}
