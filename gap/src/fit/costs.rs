//! The cost of a model on windows of data.

use super::part::Part;
use super::whitening::dot;

/// The cost of a model on the windows of a part.
#[derive(Clone, Debug)]
pub(crate) struct Costs {
    /// Mean squared whitened residual of each window, by running index over all series. It is NaN for windows that take no part.
    pub per_sample: Vec<f64>,
    /// Cost of the deviations of the model parameters from their stated values.
    pub prior: f64,
}

impl Costs {
    pub(crate) fn new(whitened: &[Vec<f64>], prior: f64) -> Self {
        let per_sample = whitened.iter().map(|r| {
            if r.is_empty() {
                f64::NAN
            } else {
                let c = dot(r, r) / r.len() as f64;
                // A model that diverges has the largest cost.
                if c.is_finite() { c } else { f64::MAX }
            }
        });
        Self {
            per_sample: per_sample.collect(),
            prior,
        }
    }

    /// Robust cost of one window: `ln(1 + c/n)`. An exact model has an expected cost of about ln 2.
    pub(crate) fn log(&self, window: usize) -> f64 {
        self.per_sample[window].ln_1p()
    }

    /// Cost of each window in `there` less its cost here.
    pub(crate) fn gains(&self, there: &Self) -> Vec<f64> {
        let windows = 0..self.per_sample.len();
        windows.map(|w| there.log(w) - self.log(w)).collect()
    }

    /// Keeps the costs of the windows of `part`.
    pub(crate) fn within(mut self, part: Part<'_>) -> Self {
        for (w, cost) in self.per_sample.iter_mut().enumerate() {
            if !part.has(w) {
                *cost = f64::NAN;
            }
        }
        self
    }

    fn included(&self) -> impl Iterator<Item = f64> {
        self.per_sample.iter().copied().filter(|c| !c.is_nan())
    }

    /// The objective of a fit: the sum of the robust costs of the windows that take part, and the prior cost.
    pub(crate) fn sum(&self) -> f64 {
        self.included().map(f64::ln_1p).sum::<f64>() + self.prior
    }

    /// The objective of a fit divided by the number of windows.
    pub(crate) fn level(&self) -> f64 {
        self.sum() / self.included().count().max(1) as f64
    }

    /// Mean robust cost of a window, without the prior cost.
    pub(crate) fn mean(&self) -> f64 {
        self.level() - self.prior / self.included().count().max(1) as f64
    }
}
