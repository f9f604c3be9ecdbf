//! Estimates the error scale: the rms deviation of a model beyond noise, estimated from the residual of its best fit.

use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;

/// Number of iterations of the fit between two estimates of the scale.
pub(super) const ITERATIONS: usize = 6;
/// Largest number of estimates of the scale.
const MOST_LOOKS: usize = 6;
/// Ratio of two successive scales above which the scale has converged.
const SETTLED: f64 = 0.7;

/// Returns a fit and its error scale, estimated together. The scale begins at the rms residual, where all windows have similar weights. It
/// decreases to the rms residual of the fit beyond the noise. The scale is in position units, and at least the allowed model error of
/// `problem`.
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

/// Returns the rms residual of a fit, in position units.
fn rms(problem: &Problem<'_>, fit: &Fit) -> f64 {
    problem.rms(&problem.window_squares(fit, Part::All))
}

/// Returns the rms residual of a fit beyond the sensor noise, in position units.
fn excess(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let noise = problem.series.iter().flat_map(|series| {
        let windows = series.windows.iter();
        windows.map(|window| window.samples.len() as f64 * window.noise.powi(2))
    });
    let noise = problem.rms(&noise.collect::<Vec<f64>>());
    let left = rms(problem, fit);
    (left * left - noise * noise).max(0.0).sqrt()
}

/// Returns the rms residual of a fit beyond what sensor noise and restarts explain, in position units. It is zero for an exact model.
pub(super) fn beyond_noise_and_restart(problem: &Problem<'_>, fit: &Fit) -> f64 {
    let exact = problem.exact();
    let costs = exact.costs(&fit.hypothesis, &fit.x, Part::All).per_sample;
    let windows = exact.series.iter().flat_map(|series| &series.windows);
    let squares = windows.zip(costs).map(|(window, cost)| {
        window.samples.len() as f64 * window.noise.powi(2) * (cost - 1.0).max(0.0)
    });
    exact.rms(&squares.collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn a_wrong_model_has_an_error_and_an_exact_one_has_none() {
        let error_and_gap = |hidden: &[&str]| {
            let recording = made::recording(hidden);
            let problem = made::problem(&recording);
            let bare = Hypothesis { terms: Vec::new() };
            let fit = problem.fit(&bare, Vec::new(), Part::All, 0);
            (
                beyond_noise_and_restart(&problem, &fit),
                rms(&problem, &fit),
            )
        };
        let (exact, _) = error_and_gap(&[]);
        let (wrong, gap) = error_and_gap(&["torque_offset:torque=0.003"]);
        // The restarts take up a part of the residual of a wrong model.
        assert!(wrong > 0.1 * gap && wrong <= gap, "{wrong} of {gap}");
        assert!(exact < 0.05 * wrong, "{exact} and {wrong}");
    }
}
