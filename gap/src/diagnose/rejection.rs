//! Corrections that explain nothing, however they were found.

use super::unit_factor::UnitFactor;
use crate::model_free::ModelFree;
use crate::shrink::resampled;
use std::fmt;

/// Share of the residual of the better model-free predictor that a correction may leave at most, with 97.5 % probability. A model
/// that stands still or coasts leaves all of it.
const MOST_OF_MODEL_FREE: f64 = 0.8;

/// Lowest shrink with 97.5 % probability down to which a correction counts. One that acts in a window or two is missing from many
/// resamplings of the windows, which then shrink nothing and lose a little in the others.
const MOST_LOST: f64 = -0.05;

/// Why a correction explains nothing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rejection {
    /// It is a factor between units.
    UnitMistake(UnitFactor),
    /// The input never changes while the device is driven.
    FrozenInput,
    /// It leaves no less than a predictor that knows no model.
    NoBetterThanModelFree,
    /// It does not surely shrink the gap on data that its fit has not seen.
    ShrinksNothing,
}

impl Rejection {
    /// The reason to reject a correction that leaves these squares of each window, if there is one. `shrink` is its lowest value
    /// with 95 % probability.
    pub(super) fn of(after: &[f64], model_free: &ModelFree, shrink: f64) -> Option<Self> {
        if shrink < MOST_LOST {
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
                "`input` is the same in every row although the motion does not die away: the column is frozen, and nothing can be \
                 said of what drives the device",
            ),
            Self::NoBetterThanModelFree => f.write_str(
                "no effect explains the gap: the best correction predicts no better than a position that stays where it was, or \
                 goes on at its velocity",
            ),
            Self::ShrinksNothing => f.write_str(
                "no effect explains the gap: the best correction does not surely make it smaller on data that its fit has not seen",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_stands_still_explains_nothing() {
        let squares: Vec<f64> = (0..40).map(|w| 1.0 + f64::from(w % 5)).collect();
        let model_free = ModelFree {
            standing: squares.clone(),
            coasting: squares.iter().map(|s| 3.0 * s).collect(),
        };
        let left = |share: f64| {
            squares
                .iter()
                .map(|s| share * share * s)
                .collect::<Vec<_>>()
        };
        let rejected = |share, shrink| Rejection::of(&left(share), &model_free, shrink);
        assert_eq!(rejected(1.0, 0.9), Some(Rejection::NoBetterThanModelFree));
        assert_eq!(rejected(0.5, 0.9), None);
        assert_eq!(rejected(0.5, -0.1), Some(Rejection::ShrinksNothing));
    }
}
