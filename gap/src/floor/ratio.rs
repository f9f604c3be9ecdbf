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
        self.over_floor(fit, |_| 0)[0]
    }

    /// The same of the run in which that is most: one that is driven wildly hides what the others show.
    pub(crate) fn loudest_over_floor(&self, fit: &Fit) -> f64 {
        let runs = self.over_floor(fit, |run| run);
        runs.into_iter().fold(0.0, f64::max)
    }

    /// The same of what runs make up together that are given the same place.
    fn over_floor(&self, fit: &Fit, place: impl Fn(usize) -> usize) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; self.recording.runs.len()];
        let left = self.window_squares(fit, Part::All).into_iter();
        let mut left = left.zip(self.floor_squares(fit));
        for series in &self.series {
            let [squares, floor] = &mut sums[place(series.run)];
            *floor += series.position.len() as f64 * self.modelling.powi(2);
            for (left, floored) in left.by_ref().take(series.windows.len()) {
                *squares += left;
                *floor += floored;
            }
        }
        let ratio = |[squares, floor]: [f64; 2]| (squares / floor.max(f64::MIN_POSITIVE)).sqrt();
        sums.into_iter().map(ratio).collect()
    }
}
