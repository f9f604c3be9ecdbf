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
    /// The robust cost of the windows and the prior cost.
    Robust,
    /// The same, and for each window the logarithm of the rms residual of all windows.
    RobustAndGap,
}

impl Problem<'_> {
    /// The objective at a point with the given costs and residuals.
    pub(super) fn objective(&self, costs: &Costs, residuals: &[Vec<f64>], part: Part<'_>) -> f64 {
        let robust = costs.sum();
        match self.objective {
            Objective::Robust => robust,
            Objective::RobustAndGap => {
                let (count, sum) = self.count_and_squares(residuals, part);
                robust + 0.5 * count * sum.max(f64::MIN_POSITIVE).ln()
            }
        }
    }

    /// Number of windows of a part, and the sum of their squared residuals.
    fn count_and_squares(&self, residuals: &[Vec<f64>], part: Part<'_>) -> (f64, f64) {
        let squares = self.each_window(residuals, part).map(|r| dot(r, r));
        let sum = squares.fold((0.0, 0.0), |(count, sum), square| {
            (count + 1.0, sum + square)
        });
        // A model that diverges has the largest cost.
        if sum.1.is_finite() {
            sum
        } else {
            (sum.0, f64::MAX)
        }
    }

    /// The values of each window of a part.
    fn each_window<'b>(
        &'b self,
        values: &'b [Vec<f64>],
        part: Part<'b>,
    ) -> impl Iterator<Item = &'b [f64]> {
        let series = self.series.iter().zip(values).zip(self.bases());
        series.flat_map(move |((series, values), base)| {
            let windows = series.windows.iter().enumerate();
            let included = windows.filter(move |(w, _)| part.has(base + w));
            included.map(|(_, window)| &values[window.samples.clone()])
        })
    }

    /// Normal matrix and gradient of the logarithm of the rms residual, for each window. `None` if it is no part of the objective.
    pub(super) fn gap_equations(
        &self,
        residuals: &[Vec<f64>],
        slopes: &[&Slope],
        part: Part<'_>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        if self.objective == Objective::Robust {
            return None;
        }
        let (count, sum) = self.count_and_squares(residuals, part);
        let weight = count / sum.max(f64::MIN_POSITIVE);
        let n = slopes.len();
        let product = |one: &[Vec<f64>], other: &[Vec<f64>]| {
            let pairs = self
                .each_window(one, part)
                .zip(self.each_window(other, part));
            weight * pairs.map(|(a, b)| dot(a, b)).sum::<f64>()
        };
        let mut normal = DMatrix::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                normal[(i, j)] = product(slopes[i], slopes[j]);
                normal[(j, i)] = normal[(i, j)];
            }
        }
        let gradient = slopes.iter().map(|slope| product(slope, residuals));
        Some((normal, DVector::from_iterator(n, gradient)))
    }
}
