//! Continues fits by pattern search. Slopes do not lead across a kink, a step, or a change between stick and slip.

use super::costs::Costs;
use super::fitted::Fit;
use super::part::Part;
use super::problem::Problem;
use super::slopes::clamped;
use rayon::prelude::*;

/// Steps of one coordinate that a poll tries, and the largest number of polls.
const POLL_STEPS: [f64; 10] = [-0.4, -0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2, 0.4];
const MOST_POLLS: usize = 3;
/// Least gain in robust cost of a polled step. A smaller gain is within the chance variation of a window.
const POLL_GAIN: f64 = 0.5;
/// Deviations of one model parameter that are tried as other starts, in standard deviations, and the number of these starts that are
/// fitted.
const START_DEVIATIONS: [f64; 6] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0];
const MOST_STARTS: usize = 2;

impl Problem<'_> {
    /// Fits all windows, and polls steps of each coordinate of the effects, until no step improves the fit.
    pub(crate) fn polished(&self, fit: &Fit, iterations: usize) -> Fit {
        let mut best = self.fit(&fit.hypothesis, fit.x.clone(), Part::All, iterations);
        for _ in 0..MOST_POLLS {
            let total = best.costs.sum();
            // The whitenings change little nearby.
            let here = self.predictor(&best.hypothesis, &best.x);
            let residuals = self.residuals(&here, Part::All);
            let whitenings = self.whitenings(&here, &residuals, Part::All);
            let polled = self
                .poll_points(&best, &POLL_STEPS)
                .into_par_iter()
                .map(|x| {
                    let there = self.predictor(&best.hypothesis, &x);
                    let residuals = self.residuals(&there, Part::All);
                    let costs = Costs::new(&self.whitened(&residuals, &whitenings), self.prior(&x));
                    (costs.sum(), x)
                });
            let lowest = polled.min_by(|a, b| a.0.total_cmp(&b.0));
            let lowest = lowest.filter(|(low, _)| *low < total - POLL_GAIN);
            let Some((_, x)) = lowest else {
                break;
            };
            let again = self.fit(&best.hypothesis, x, Part::All, iterations);
            if again.costs.sum() >= total {
                break;
            }
            best = again;
        }
        best
    }

    /// Fits the nominal model from starts at which one model parameter is far from its stated value. Returns the best fit if it is better
    /// than `fit`. Slopes alone do not find a friction that sticks where the stated one slides.
    pub(crate) fn nominal_afar(&self, fit: &Fit, iterations: usize) -> Option<Fit> {
        let steps = (0..self.priors.len()).flat_map(|i| START_DEVIATIONS.map(|z| (i, z)));
        let starts: Vec<Vec<f64>> = steps
            .map(|(i, z)| {
                let mut x = vec![0.0; fit.x.len()];
                x[i] = z;
                x
            })
            .collect();
        let below = fit.costs.level();
        let level = |x: &[f64]| self.costs(&fit.hypothesis, x, Part::All).level();
        let levels = starts.into_par_iter().map(|x| (level(&x), x));
        let mut lowest: Vec<_> = levels.filter(|(level, _)| *level < below).collect();
        lowest.sort_by(|a, b| a.0.total_cmp(&b.0));
        lowest.truncate(MOST_STARTS);
        let fits = lowest.into_par_iter();
        let fits = fits.map(|(_, x)| self.fit(&fit.hypothesis, x, Part::All, iterations));
        let fit = fits.min_by(|a, b| a.costs.level().total_cmp(&b.costs.level()))?;
        (fit.costs.level() < below).then_some(fit)
    }

    /// The points of one poll: steps of one coordinate of the effects, each limited to its range.
    fn poll_points(&self, fit: &Fit, steps: &[f64]) -> Vec<Vec<f64>> {
        let reaches = fit.hypothesis.reaches(&self.priors);
        let moved = (self.priors.len()..fit.x.len()).flat_map(|i| {
            let ends = steps.iter().map(move |by| (i, by));
            ends.map(|(i, by)| {
                let mut x = fit.x.clone();
                x[i] = clamped(x[i] + by, reaches[i]);
                x
            })
        });
        let mut points: Vec<Vec<f64>> = moved.collect();
        points.dedup();
        points
    }
}
