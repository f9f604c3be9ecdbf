//! The expected loss of an exact model, on a recording of the same motion with the same sensor.

use super::replicate::Replicate;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::windows::series;

/// Robust loss of a window whose residual is white with the assumed variance: ln(1 + 1).
pub(crate) const WHITE: f64 = core::f64::consts::LN_2;
/// Most that restarts and averaged inputs may add to the expected loss if the model is not known to represent the device.
const MOST_ADDED: f64 = 0.5;

/// Expected loss of an exact model, from noise, quantization, restarts at kinks of the motion, and averaged inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExpectedLoss {
    /// Mean robust loss of a window, at least [`WHITE`].
    pub level: f64,
    /// Standard error of the mean.
    pub error: f64,
    /// Loss of the worst window less the mean.
    pub worst: f64,
}

impl ExpectedLoss {
    /// The expected loss of `fit` on recordings that its own device would produce, by parametric bootstrap.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let predictor = problem.predictor(&fit.hypothesis, &fit.x);
        let (mut first, mut odd) = (Vec::new(), Vec::new());
        for replicate in Replicate::both(problem.recording, &predictor) {
            let (own, series) = replicate.observed(0, series::coarse);
            let problem = Problem {
                series,
                recording: &own,
                priors: problem.priors.clone(),
                modelling: problem.modelling,
                objective: problem.objective,
                quarter: None,
            };
            let costs = problem.costs(&fit.hypothesis, &fit.x, Part::All);
            let windows = problem.series.iter().flat_map(|s| 0..s.windows.len());
            for (window, cost) in windows.zip(0..).map(|(w, i)| (w, costs.log(i))) {
                if replicate.is_evaluated(window) {
                    let losses = if window == 0 { &mut first } else { &mut odd };
                    losses.push(cost);
                }
            }
        }
        let (_, error) = mean_and_error(&odd);
        let all = [first, odd].concat();
        let (mean, _) = mean_and_error(&all);
        let worst = all.iter().fold(mean, |m, c| m.max(*c));
        Self {
            level: mean.max(WHITE),
            error,
            worst: worst - mean,
        }
    }

    /// Limits the expected loss, for a model that may be too wrong to represent the device.
    pub(crate) fn bounded(self) -> Self {
        Self {
            level: self.level.min(WHITE + MOST_ADDED),
            ..self
        }
    }
}

/// Mean of a list of values and its standard error. Both are 0 for an empty list.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, (variance / n).sqrt())
}
