//! What a model costs on windows of data.

use super::part::Part;
use super::whitening::dot;

/// What one point costs on the windows of a part.
#[derive(Clone, Debug)]
pub(crate) struct Costs {
    /// Whitened squared residual per sample, by running index; NaN for windows that take no part.
    pub per_sample: Vec<f64>,
    /// Cost of moving the model's own numbers within their tolerances.
    pub prior: f64,
}

impl Costs {
    pub(crate) fn new(whitened: &[Vec<f64>], prior: f64) -> Self {
        let per_sample = whitened.iter().map(|r| {
            if r.is_empty() {
                f64::NAN
            } else {
                let c = dot(r, r) / r.len() as f64;
                // A model that runs away is bad, not undefined.
                if c.is_finite() { c } else { f64::MAX }
            }
        });
        Self {
            per_sample: per_sample.collect(),
            prior,
        }
    }

    /// Robust cost of one window: `ln(1 + c/n)`, from ln 2 for a perfect model.
    pub(crate) fn log(&self, window: usize) -> f64 {
        self.per_sample[window].ln_1p()
    }

    /// By how much less each window costs here than there.
    pub(crate) fn gains(&self, there: &Self) -> Vec<f64> {
        let windows = 0..self.per_sample.len();
        windows.map(|w| there.log(w) - self.log(w)).collect()
    }

    /// Those of the windows of a part alone.
    pub(crate) fn within(mut self, part: Part<'_>) -> Self {
        for (w, cost) in self.per_sample.iter_mut().enumerate() {
            if !part.has(w) {
                *cost = f64::NAN;
            }
        }
        self
    }

    fn taken(&self) -> impl Iterator<Item = f64> {
        self.per_sample.iter().copied().filter(|c| !c.is_nan())
    }

    /// What a fit makes least: the robust costs of the windows that took part and the prior.
    pub(crate) fn sum(&self) -> f64 {
        self.taken().map(f64::ln_1p).sum::<f64>() + self.prior
    }

    /// The same per window.
    pub(crate) fn level(&self) -> f64 {
        self.sum() / self.taken().count().max(1) as f64
    }

    /// The same without the prior.
    pub(crate) fn mean(&self) -> f64 {
        self.level() - self.prior / self.taken().count().max(1) as f64
    }
}
