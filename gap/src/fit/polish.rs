//! Fits carried on where slopes lead no further: they say nothing across a kink, a step or a change of what sticks.

use super::costs::Costs;
use super::fitted::Fit;
use super::part::Part;
use super::problem::Problem;
use super::slopes::within;
use rayon::prelude::*;

/// Moves of one coordinate that are looked at, and how often.
const POLLED: [f64; 10] = [-0.4, -0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2, 0.4];
const MOST_POLLS: usize = 3;
/// What such a move must gain in robust cost: less is within what a window leaves by chance.
const POLL_GAIN: f64 = 0.5;
/// Standard deviations by which a number of the model is moved to look for a better start, and how many of these starts are fitted.
const NUDGED: [f64; 6] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0];
const NUDGED_KEPT: usize = 2;

impl Problem<'_> {
    /// A fit to all windows carried on until looking to both sides along each coordinate of its effects leads no further.
    pub(crate) fn polished(&self, fit: &Fit, iterations: usize) -> Fit {
        let mut best = self.fit(&fit.hypothesis, fit.x.clone(), Part::All, iterations);
        for _ in 0..MOST_POLLS {
            let total = best.costs.sum();
            // How uncertain the restarts leave the windows changes little nearby.
            let here = self.predictor(&best.hypothesis, &best.x);
            let residuals = self.residuals(&here, Part::All);
            let whitenings = self.whitenings(&here, &residuals, Part::All);
            let polled = self.beside(&best, &POLLED).into_par_iter().map(|x| {
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

    /// The nominal model fitted from where one of its own numbers lies far from what is stated, if that leaves less. Slopes do not find
    /// a friction that holds where the stated one slides.
    pub(crate) fn nominal_afar(&self, fit: &Fit, iterations: usize) -> Option<Fit> {
        let moves = (0..self.priors.len()).flat_map(|i| NUDGED.map(|z| (i, z)));
        let starts: Vec<Vec<f64>> = moves
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
        lowest.truncate(NUDGED_KEPT);
        let fits = lowest.into_par_iter();
        let fits = fits.map(|(_, x)| self.fit(&fit.hypothesis, x, Part::All, iterations));
        let fit = fits.min_by(|a, b| a.costs.level().total_cmp(&b.costs.level()))?;
        (fit.costs.level() < below).then_some(fit)
    }

    /// The points to which moves of one coordinate of its effects lead from a fit, each within its reach.
    fn beside(&self, fit: &Fit, moves: &[f64]) -> Vec<Vec<f64>> {
        let reaches = fit.hypothesis.reaches(&self.priors);
        let moved = (self.priors.len()..fit.x.len()).flat_map(|i| {
            let ends = moves.iter().map(move |by| (i, by));
            ends.map(|(i, by)| {
                let mut x = fit.x.clone();
                x[i] = within(x[i] + by, reaches[i]);
                x
            })
        });
        let mut points: Vec<Vec<f64>> = moved.collect();
        points.dedup();
        points
    }
}
