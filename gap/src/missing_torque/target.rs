//! The estimated missing torque as the target of a fit.

use super::form::Form;
use super::path::Path;
use super::ripple::Waves;
use nalgebra::{DMatrix, DVector};

/// The missing torque that forms are to explain, with further results of the smoother.
pub(crate) struct Target<'a> {
    /// Estimated missing torque of each row.
    pub torque: &'a [f64],
    /// Corner frequency of the smoother, rad/s.
    pub corner: f64,
    /// Indices of the rows of a fit.
    pub rows: &'a [usize],
    /// Weight of each row; 0 for a row outside the fit.
    pub weight: &'a [f64],
    /// Innovation of each row, in its standard deviations.
    pub innovation: &'a [f64],
    /// Wave numbers over the position that the torque may have.
    pub waves: &'a Waves,
}

impl Target<'_> {
    /// The `count` forms that explain most of the torque. The forms are not smoothed like the torque for this comparison.
    pub fn screened(&self, forms: Vec<Form>, count: usize) -> Vec<Form> {
        if forms.len() <= count {
            return forms;
        }
        let tried = forms
            .into_iter()
            .map(|form| (self.explained(&form.torque), form));
        let mut tried: Vec<(f64, Form)> = tried.collect();
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        tried.truncate(count);
        tried.into_iter().map(|(_, form)| form).collect()
    }

    /// Weighted sum of squares that some torques explain by least squares.
    pub fn explained(&self, torque: &[Vec<f64>]) -> f64 {
        let n = torque.len();
        let mut normal = DMatrix::<f64>::zeros(n, n);
        let mut right = DVector::<f64>::zeros(n);
        for (&row, weight) in self.rows.iter().map(|row| (row, self.weight[*row])) {
            for a in 0..n {
                right[a] += weight * torque[a][row] * self.torque[row];
                for b in 0..=a {
                    normal[(a, b)] += weight * torque[a][row] * torque[b][row];
                }
            }
        }
        for a in 0..n {
            normal[(a, a)] += 1e-9 * normal[(a, a)] + f64::MIN_POSITIVE;
        }
        let solved = normal.cholesky().map(|c| c.solve(&right));
        solved.map_or(0.0, |solved| solved.dot(&right))
    }

    /// Coefficient of one torque by least squares.
    pub fn coefficient(&self, torque: &[f64]) -> f64 {
        let (mut square, mut product) = (0.0, 0.0);
        for (&row, weight) in self.rows.iter().map(|row| (row, self.weight[*row])) {
            square += weight * torque[row] * torque[row];
            product += weight * torque[row] * self.torque[row];
        }
        if square > 0.0 { product / square } else { 0.0 }
    }

    /// First and last row of the interval whose missing torque exceeds twice the mean by the largest sum.
    pub fn most_missing(&self, path: &Path<'_>) -> Option<(usize, usize)> {
        let missing = |i: usize| (self.weight[i] * self.torque[i].powi(2)).sqrt();
        let rows = 0..path.samples.len();
        let total_weight: f64 = self.weight.iter().map(|w| w.sqrt()).sum();
        let mean = rows.map(missing).sum::<f64>() / total_weight.max(f64::MIN_POSITIVE);
        let mut best: Option<(f64, usize, usize)> = None;
        for stretch in &path.samples.stretches {
            let (mut sum, mut from) = (0.0, stretch.rows.start);
            for row in stretch.rows.clone() {
                if sum <= 0.0 {
                    (sum, from) = (0.0, row);
                }
                // Twice the mean is subtracted, so that a usual missing torque does not add up.
                sum += missing(row) - 2.0 * mean * self.weight[row].sqrt();
                if best.is_none_or(|(most, ..)| sum > most) {
                    best = Some((sum, from, row));
                }
            }
        }
        best.filter(|(sum, from, to)| *sum > 0.0 && to > from)
            .map(|(_, from, to)| (from, to))
    }
}
