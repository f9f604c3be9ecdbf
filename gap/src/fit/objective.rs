//! The objective that a fit minimizes.

use super::costs::Costs;
use super::part::Part;
use super::problem::Problem;
use super::slopes::Slope;
use super::whitening::dot;

/// The objective that a fit minimizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Objective {
    /// The sum of the robust costs of the windows, and the prior cost.
    Robust,
    /// The sum of the robust costs of the windows, the prior cost, and the number of windows times the logarithm of the rms residual. The
    /// robust cost of a window hardly grows when its prediction becomes worse. If residuals are far above the noise, the minimum of the
    /// robust costs alone may therefore have a large gap.
    RobustAndGap,
}

/// The part of the equations of one step that comes from the logarithm of the rms residual.
pub(super) struct GapEquations<'a> {
    /// Weight of the squared residuals of each window.
    pub weight: f64,
    /// Residuals of each window, by running index.
    pub residuals: Vec<&'a [f64]>,
    /// Slopes of the residuals along each coordinate, for each window.
    pub slopes: Vec<Vec<&'a [f64]>>,
}

impl Problem<'_> {
    /// The objective at a point with the given costs and residuals.
    pub(super) fn objective(&self, costs: &Costs, residuals: &[Vec<f64>], part: Part<'_>) -> f64 {
        match self.objective {
            Objective::Robust => costs.sum(),
            Objective::RobustAndGap => {
                let [count, squares] = self.count_and_squares(residuals, part);
                costs.sum() + 0.5 * count * squares.ln()
            }
        }
    }

    /// The equations of the logarithm of the rms residual. `None` if the objective does not contain it.
    pub(super) fn gap_equations<'a>(
        &'a self,
        residuals: &'a [Vec<f64>],
        slopes: impl Iterator<Item = &'a Slope>,
        part: Part<'_>,
    ) -> Option<GapEquations<'a>> {
        match self.objective {
            Objective::Robust => None,
            Objective::RobustAndGap => {
                let [count, squares] = self.count_and_squares(residuals, part);
                Some(GapEquations {
                    weight: count / squares,
                    residuals: self.by_window(residuals).collect(),
                    slopes: slopes
                        .map(|slope| self.by_window(slope).collect())
                        .collect(),
                })
            }
        }
    }

    /// Number of windows of a part, and the sum of their squared residuals.
    fn count_and_squares(&self, residuals: &[Vec<f64>], part: Part<'_>) -> [f64; 2] {
        let windows = self.by_window(residuals).enumerate();
        let squares = windows.filter(|(w, _)| part.has(*w));
        let squares: Vec<f64> = squares.map(|(_, r)| dot(r, r)).collect();
        let sum: f64 = squares.iter().sum();
        // A model that diverges has the largest cost.
        let sum = if sum.is_finite() { sum } else { f64::MAX };
        [squares.len() as f64, sum.max(f64::MIN_POSITIVE)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    #[test]
    fn a_fit_of_the_gap_is_nearer_to_the_windows_that_are_predicted_badly() {
        // A torque acts for a third of the time. A constant torque in its place predicts other windows badly.
        let recording = made::recording(&["push:torque=0.03,from=2.0,to=4.0"]);
        let offset = Coordinate {
            parameter: 0,
            start: 0.0,
            scale: Scale::Linear(1e-3),
        };
        let hypothesis = Hypothesis {
            terms: vec![made::term("torque_offset", &[offset])],
        };
        let gap = |objective| {
            let problem = made::problem(&recording).off_by(0.02);
            let problem = problem.with_objective(objective);
            let fit = problem.fit(&hypothesis, vec![0.0], Part::All, 12);
            (problem.plain_gap(&problem.series, &fit), fit.costs.sum())
        };
        let (robust_gap, robust_cost) = gap(Objective::Robust);
        let (both_gap, both_cost) = gap(Objective::RobustAndGap);
        assert!(both_gap < robust_gap, "{both_gap} {robust_gap}");
        assert!(both_cost > robust_cost, "{both_cost} {robust_cost}");
    }
}
