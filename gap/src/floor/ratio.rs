//! The residual of a fit relative to its floor.

use super::{SAMPLED_WINDOWS, floor_squares};
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::windows::series;

impl Problem<'_> {
    /// Expected sum of squared residuals in each window if this fit were exact.
    pub(crate) fn floor_squares(&self, fit: &Fit) -> Vec<f64> {
        let predictor = self.predictor(&fit.hypothesis, &fit.x);
        let series = self.series.iter();
        let windows = series.flat_map(|s| s.windows.iter().map(move |w| (s.run, w)));
        floor_squares(
            self.recording,
            &predictor,
            windows,
            series::coarse,
            SAMPLED_WINDOWS,
        )
    }

    /// Rms residual of a fit over its floor, which includes the allowed model error.
    pub(crate) fn gap_over_floor(&self, fit: &Fit) -> f64 {
        let add = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
        ratio(self.squares_by_run(fit).into_iter().fold([0.0; 2], add))
    }

    /// The largest ratio of rms residual to floor among the runs. One run with large motion can hide an error that the other runs show.
    pub(crate) fn worst_run_over_floor(&self, fit: &Fit) -> f64 {
        let runs = self.squares_by_run(fit).into_iter();
        runs.map(ratio).fold(0.0, f64::max)
    }

    /// Sum of squared residuals of each run, and its floor including the allowed model error.
    fn squares_by_run(&self, fit: &Fit) -> Vec<[f64; 2]> {
        let mut sums = vec![[0.0; 2]; self.recording.runs.len()];
        let residuals = self.window_squares(fit, Part::All).into_iter();
        let mut residuals = residuals.zip(self.floor_squares(fit));
        for series in &self.series {
            let [squares, floor] = &mut sums[series.run];
            *floor += series.position.len() as f64 * self.modelling.powi(2);
            for (square, window_floor) in residuals.by_ref().take(series.windows.len()) {
                *squares += square;
                *floor += window_floor;
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
    fn an_effect_in_one_run_raises_the_ratio_of_that_run() {
        let held = "contact:position=0.02,side=0,stiffness=0.3,damping=0.003,from=8,to=8.9";
        let recording = made::recording(&[held]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let [overall, worst] = [
            problem.gap_over_floor(&null),
            problem.worst_run_over_floor(&null),
        ];
        assert!(worst > 1.3 * overall && overall > 3.0, "{worst} {overall}");
    }
}
