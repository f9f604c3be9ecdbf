//! What a fit leaves, beside what it would leave if it were right.

use super::{LOOKED_AT, floor_squares};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
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
        let add = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
        ratio(self.squares_by_run(fit).into_iter().fold([0.0; 2], add))
    }

    /// The same of the run in which that is most: one that is driven wildly hides what the others show.
    pub(crate) fn worst_run_over_floor(&self, fit: &Fit) -> f64 {
        let runs = self.squares_by_run(fit).into_iter();
        runs.map(ratio).fold(0.0, f64::max)
    }

    /// Squares that a fit leaves of each run, and those that noise, restarts and what it may be off by would.
    fn squares_by_run(&self, fit: &Fit) -> Vec<[f64; 2]> {
        let mut sums = vec![[0.0; 2]; self.recording.runs.len()];
        let left = self.window_squares(fit, Part::All).into_iter();
        let mut left = left.zip(self.floor_squares(fit));
        for series in &self.series {
            let [squares, floor] = &mut sums[series.run];
            *floor += series.position.len() as f64 * self.modelling.powi(2);
            for (left, floored) in left.by_ref().take(series.windows.len()) {
                *squares += left;
                *floor += floored;
            }
        }
        sums
    }
}

fn ratio([squares, floor]: [f64; 2]) -> f64 {
    (squares / floor.max(f64::MIN_POSITIVE)).sqrt()
}

#[cfg(test)]
mod tests {
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;

    #[test]
    fn what_one_run_shows_is_loudest_there() {
        let held = "contact:position=0.02,side=0,stiffness=0.3,damping=0.003,from=8,to=8.9";
        let recording = made::recording(&[held]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let [overall, loudest] = [
            problem.gap_over_floor(&null),
            problem.worst_run_over_floor(&null),
        ];
        assert!(
            loudest > 1.3 * overall && overall > 3.0,
            "{loudest} {overall}"
        );
    }
}
