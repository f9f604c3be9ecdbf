//! The objective that a fit minimizes.

use super::costs::Costs;
use super::part::Part;
use super::problem::Problem;
use super::slopes::Slope;
use super::whitening::dot;
use nalgebra::{DMatrix, DVector};

/// The objective that a fit minimizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Objective {
    /// The robust cost of the windows, and the prior cost.
    Robust,
    /// The same, plus the logarithm of the rms residual of all windows, once for each window. The robust cost alone barely counts a window
    /// that is predicted badly, so that far above the noise its minimum may have a large gap.
    RobustAndGap,
}

/// The contribution of the logarithm of the rms residual to the equations of one step.
pub(super) struct GapEquations {
    pub normal: DMatrix<f64>,
    /// Gradient of each window, by running index. It is `None` for windows that take no part.
    pub scores: Vec<Option<DVector<f64>>>,
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

    /// The equations of the logarithm of the rms residual, with the slopes of the residuals along all coordinates. `None` if the objective
    /// does not contain it.
    pub(super) fn gap_equations(
        &self,
        residuals: &[Vec<f64>],
        slopes: &[&Slope],
        part: Part<'_>,
    ) -> Option<GapEquations> {
        if self.objective == Objective::Robust {
            return None;
        }
        let [count, squares] = self.count_and_squares(residuals, part);
        let weight = count / squares;
        let n = slopes.len();
        let slopes: Vec<Vec<&[f64]>> = slopes.iter().map(|slope| self.by_window(slope)).collect();
        let mut normal = DMatrix::zeros(n, n);
        let windows = self.by_window(residuals).into_iter().enumerate();
        let scores = windows.map(|(w, residual)| {
            part.has(w).then(|| {
                for i in 0..n {
                    for j in 0..=i {
                        normal[(i, j)] += weight * dot(slopes[i][w], slopes[j][w]);
                    }
                }
                let along = slopes.iter().map(|slope| weight * dot(slope[w], residual));
                DVector::from_iterator(n, along)
            })
        });
        let scores = scores.collect();
        normal.fill_upper_triangle_with_lower_triangle();
        Some(GapEquations { normal, scores })
    }

    /// Number of windows of a part, and the sum of their squared residuals.
    fn count_and_squares(&self, residuals: &[Vec<f64>], part: Part<'_>) -> [f64; 2] {
        let windows = self.by_window(residuals).into_iter().enumerate();
        let squares = windows.filter(|(w, _)| part.has(*w));
        let squares: Vec<f64> = squares.map(|(_, r)| dot(r, r)).collect();
        let sum: f64 = squares.iter().sum();
        // A model that diverges has the largest cost.
        let sum = if sum.is_finite() { sum } else { f64::MAX };
        [squares.len() as f64, sum.max(f64::MIN_POSITIVE)]
    }

    /// The values of each window, by running index, from those of each series.
    fn by_window<'b>(&self, values: &'b [Vec<f64>]) -> Vec<&'b [f64]> {
        let pairs = self.series.iter().zip(values);
        let windows = pairs.flat_map(|(series, values)| {
            let windows = series.windows.iter();
            windows.map(|window| &values[window.samples.clone()])
        });
        windows.collect()
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
