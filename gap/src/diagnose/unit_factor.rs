//! Detects gains that are a factor between units: a column or a model parameter has another unit than assumed.

use crate::fit::Fit;
use crate::fit::problem::Problem;
use core::f64::consts::{PI, TAU};
use host_sim::effects::Quantity;
use std::fmt;

/// Common unit mistakes: the factor, and the units that it converts.
const FACTORS: [(f64, &str); 5] = [
    (180.0 / PI, "degrees and radians"),
    (60.0 / TAU, "revolutions per minute and radians per second"),
    (TAU, "turns and radians"),
    (1000.0, "a unit and its thousandth"),
    (100.0, "a unit and its hundredth"),
];

/// Largest distance between a gain and a factor: a share of the gain, or a number of standard deviations of the fit, up to a largest
/// share. An effect that is not modelled biases a fitted gain by some percent.
const RELATIVE: f64 = 0.02;
const DEVIATIONS: f64 = 3.0;
const MOST: f64 = 0.05;

/// A gain that is a factor between units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnitFactor {
    /// The fitted gain.
    gain: f64,
    /// The units that it converts.
    between: String,
}

impl UnitFactor {
    /// The first gain, among the effects of a fit beyond its first `kept` terms, that converts between units.
    pub(super) fn in_fit(problem: &Problem<'_>, fit: &Fit, kept: usize) -> Option<Self> {
        let model = &problem.recording.model;
        let resolution = problem.recording.sensor("position").resolution;
        let mut own_factors = vec![(model.ratio.abs(), "the two sides of the gear")];
        if resolution > 0.0 {
            own_factors.push((TAU / resolution, "counts and radians"));
        }
        let parts = fit
            .hypothesis
            .parts(&fit.x)
            .zip(fit.hypothesis.parts(&fit.std));
        parts.skip(kept).find_map(|((term, x), (_, std))| {
            let value = term.at(x)[0];
            let spread = term.spread(0, x, std);
            match term.kind.parameter(0).quantity {
                Quantity::Inertia => {
                    Self::of(value / model.inertia, spread / model.inertia, &own_factors)
                }
                Quantity::Ratio if term.kind.name.ends_with("gain") => {
                    Self::of(value, spread, &own_factors)
                }
                _ => None,
            }
        })
    }

    /// The units that a gain converts, if it is one of the common factors or of the factors `own_factors` of the recording: the gear ratio and
    /// the counts per revolution.
    pub(super) fn of(gain: f64, std: f64, own_factors: &[(f64, &str)]) -> Option<Self> {
        let near = (RELATIVE * gain.abs())
            .max(DEVIATIONS * std)
            .min(MOST * gain.abs());
        let known = |factor: f64| (gain.abs() - factor).abs() <= near;
        let all = FACTORS.iter().chain(own_factors);
        let mut all = all.filter(|(factor, _)| (factor.ln()).abs() > LEAST_LOG);
        let (_, between) = all.find(|(factor, _)| known(*factor) || known(factor.recip()))?;
        Some(Self {
            gain,
            between: (*between).to_owned(),
        })
    }
}

/// Least magnitude of the logarithm of a factor. A ratio of 2, for example, is a plausible gain.
const LEAST_LOG: f64 = 1.5;

impl fmt::Display for UnitFactor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a gain of {:.5} is the factor between {}: a column or a parameter of [model] has another unit than stated; give both in \
             the same unit",
            self.gain, self.between
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_between_units_is_recognised_in_both_directions() {
        let between =
            |gain: f64| UnitFactor::of(gain, 1e-4, &[(15.0, "the two sides of the gear")]);
        for gain in [
            0.017438,
            57.4,
            0.1047,
            9.55,
            TAU,
            1e-3,
            -1000.0,
            15.1,
            1.0 / 15.0,
        ] {
            assert!(between(gain).is_some(), "{gain}");
        }
        for gain in [0.85, 1.4, 2.0, 0.02, 40.0] {
            assert_eq!(between(gain), None, "{gain}");
        }
    }
}
