//! Two predictors that know no model: the position stays where it was at the restart, or goes on at the restart's velocity.

use crate::windows::series::Series;

/// Squared residuals of both predictors, by window, in units of position squared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ModelFree {
    /// Of the position at the restart.
    pub standing: Vec<f64>,
    /// Of the restart's velocity kept.
    pub coasting: Vec<f64>,
}

impl ModelFree {
    /// On all windows of some series, by running index.
    pub(crate) fn of(series: &[Series]) -> Self {
        let mut all = Self {
            standing: Vec::new(),
            coasting: Vec::new(),
        };
        for series in series {
            for window in &series.windows {
                let restart = &window.restart;
                let samples = window.samples.clone();
                let squares = |rate: f64| -> f64 {
                    let residuals = samples.clone().map(|i| {
                        let elapsed_s = series.time[i] - restart.time_s;
                        series.position[i] - restart.value - rate * elapsed_s
                    });
                    residuals.map(|residual| residual * residual).sum()
                };
                all.standing.push(squares(0.0));
                all.coasting.push(squares(restart.slope));
            }
        }
        all
    }

    /// The predictor that leaves less over all windows.
    pub(crate) fn better(&self) -> &[f64] {
        let sum = |squares: &[f64]| squares.iter().sum::<f64>();
        if sum(&self.standing) <= sum(&self.coasting) {
            &self.standing
        } else {
            &self.coasting
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::windows::series;

    #[test]
    fn what_coasts_is_predicted_by_its_restart_alone() {
        let mut recording = made::recording(&[]);
        for run in &mut recording.runs {
            run.position = run.time.iter().map(|t| 0.3 * t).collect();
        }
        let left = ModelFree::of(&series::coarse(&recording, recording.horizon));
        let sum = |squares: &[f64]| squares.iter().sum::<f64>();
        let [standing, coasting] = [sum(&left.standing), sum(&left.coasting)];
        assert!(coasting < 1e-12 * standing, "{coasting} {standing}");
        assert_eq!(left.better(), left.coasting);
    }
}
