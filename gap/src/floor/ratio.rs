//! What a fit leaves, beside what it would leave if it were right.

use super::{LOOKED_AT, floor_squares};
use crate::fit::Fit;
use crate::fit::problem::{Part, Problem};
use crate::windows::series;

impl Problem<'_> {
    /// Squares that noise and restarts alone would leave in each window with this fit.
    pub(crate) fn floor_squares(&self, fit: &Fit) -> Vec<f64> {
        let predictor = self.predictor(&fit.hypothesis, &fit.x);
        let series = self.series.iter();
        let windows = series.flat_map(|s| s.windows.iter().map(move |w| (s.run, w)));
        floor_squares(
            self.recording,
            &predictor,
            windows,
            series::coarse,
            LOOKED_AT,
        )
    }

    /// Root mean square of what a fit leaves, over that of what noise, restarts and what it may be off by would.
    pub(crate) fn gap_over_floor(&self, fit: &Fit) -> f64 {
        let squares: f64 = self.window_squares(fit, Part::All).iter().sum();
        let floor: f64 = self.floor_squares(fit).iter().sum();
        let samples: usize = self.series.iter().map(|s| s.position.len()).sum();
        let off = samples as f64 * self.modelling.powi(2);
        (squares / (floor + off).max(f64::MIN_POSITIVE)).sqrt()
    }
}
