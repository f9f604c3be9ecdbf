//! The loss that is expected of a model that is exact, on a recording of the same motion with the same sensor.

use super::replicate::Replicate;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::windows::series;

/// Robust cost of a window whose residual is white and of the known size: ln(1 + 1).
pub(crate) const WHITE: f64 = core::f64::consts::LN_2;
/// Most that restarts and inputs may add where nothing says that the model stands in for the device.
const MOST_ADDED: f64 = 0.5;

/// Expected loss if the model is exact: from noise, quantising, restarts on a kink of the motion, and inputs that are means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExpectedLoss {
    /// Mean robust cost of a window, [`WHITE`] at least.
    pub level: f64,
    /// Standard error of that.
    pub error: f64,
    /// Of the worst window, above the mean.
    pub worst: f64,
}

impl ExpectedLoss {
    /// Of `fit`, on what its own device would have given.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let predictor = problem.predictor(&fit.hypothesis, &fit.x);
        let (mut first, mut odd) = (Vec::new(), Vec::new());
        for replicate in Replicate::both(problem.recording, &predictor) {
            let (own, series) = replicate.shown(0, series::coarse);
            let problem = Problem {
                series,
                recording: &own,
                priors: problem.priors.clone(),
                modelling: problem.modelling,
                quarter: None,
            };
            let costs = problem.costs(&fit.hypothesis, &fit.x, Part::All);
            let windows = problem.series.iter().flat_map(|s| 0..s.windows.len());
            for (window, cost) in windows.zip(0..).map(|(w, i)| (w, costs.log(i))) {
                if replicate.tells(window) {
                    let told = if window == 0 { &mut first } else { &mut odd };
                    told.push(cost);
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

    /// The same for a model that may be too wrong to stand in for the device.
    pub(crate) fn bounded(self) -> Self {
        Self {
            level: self.level.min(WHITE + MOST_ADDED),
            ..self
        }
    }
}

/// Mean of some values and its standard error; zeros for none.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, (variance / n).sqrt())
}
