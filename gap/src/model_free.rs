//! Two model-free predictors: one keeps the position at the restart, the other the velocity at the restart.

use crate::windows::series::Series;

/// Sum of squared residuals of each window for both predictors, in position units squared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ModelFree {
    /// Squares of the predictor that keeps the position.
    pub standing: Vec<f64>,
    /// Squares of the predictor that keeps the velocity.
    pub coasting: Vec<f64>,
}

impl ModelFree {
    /// Evaluates both predictors on all windows of some series.
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

    /// Squares of the predictor with the smaller sum.
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
    fn a_motion_of_constant_velocity_is_predicted_by_its_restart() {
        let mut recording = made::recording(&[]);
        for run in &mut recording.runs {
            run.position = run.time.iter().map(|t| 0.3 * t).collect();
        }
        let model_free = ModelFree::of(&series::coarse(&recording, recording.horizon));
        let sum = |squares: &[f64]| squares.iter().sum::<f64>();
        let [standing, coasting] = [sum(&model_free.standing), sum(&model_free.coasting)];
        assert!(coasting < 1e-12 * standing, "{coasting} {standing}");
        assert_eq!(model_free.better(), model_free.coasting);
    }
}
