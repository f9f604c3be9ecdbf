//! The error scale: by how much a model may be off beyond noise, estimated from what its best fit leaves.

use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;

/// Fits between two looks at the scale, and looks at most.
pub(super) const ITERATIONS: usize = 6;
const MOST_LOOKS: usize = 6;
/// A scale that falls by less than this factor has settled.
const SETTLED: f64 = 0.7;

/// A fit whose error scale was estimated with it: it begins at the size of the residual, where every window counts alike, and
/// falls to what the fit leaves beyond the noise. A model that is exact ends at the noise alone. The scale is rms, in units of
/// position, and never below that of `problem`.
pub(super) fn annealed(problem: &Problem<'_>, hypothesis: &Hypothesis, x: Vec<f64>) -> (Fit, f64) {
    let start = problem.fit(hypothesis, x, Part::All, 0);
    let mut scale = rms(problem, &start).max(problem.modelling);
    let mut fit = start;
    for _ in 0..MOST_LOOKS {
        let scaled = problem.off_by(scale);
        fit = scaled.fit(hypothesis, fit.x.clone(), Part::All, ITERATIONS);
        let next = excess(problem, &fit).max(problem.modelling);
        let is_settled = next > SETTLED * scale;
        scale = next.min(scale);
        if is_settled || scale <= problem.modelling {
            break;
        }
    }
    let scaled = problem.off_by(scale);
    (scaled.fit(hypothesis, fit.x, Part::All, ITERATIONS), scale)
}

/// Root mean square of the residual of a fit, in units of position.
fn rms(problem: &Problem<'_>, fit: &Fit) -> f64 {
    problem.rms(&problem.window_squares(fit, Part::All))
}

/// The same beyond the noise of the sensor.
fn excess(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let noise = problem.series.iter().flat_map(|series| {
        let windows = series.windows.iter();
        windows.map(|window| window.samples.len() as f64 * window.noise.powi(2))
    });
    let noise = problem.rms(&noise.collect::<Vec<f64>>());
    let left = rms(problem, fit);
    (left * left - noise * noise).max(0.0).sqrt()
}
