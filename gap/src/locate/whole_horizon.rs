//! The axis along which the error of predictions over a whole horizon is largest.

use super::bins::{Bins, Point};
use super::evidence::{BINS, Evidence, LEAST_SURPLUS};
use crate::diagnosis::MeasuredBy;
use crate::windows::series::{Series, slopes};

/// Computes one value per sample of a series.
type Column<'a> = &'a dyn Fn(&Series) -> Vec<f64>;

/// The axis of the motion, not among `excluded`, with the largest surplus of the squared errors of `predictions` over whole horizons.
/// Slopes are difference quotients over `half_width_s` on both sides of a sample. Time is no candidate, because a gap is uneven over time
/// whatever its cause.
pub(super) fn whole_horizon_axis(
    series: &[Series],
    predictions: &[Vec<f64>],
    half_width_s: f64,
    excluded: &[&str],
) -> Option<Evidence> {
    let velocity = move |s: &Series| slopes(&s.time, &s.position, half_width_s);
    let acceleration = move |s: &Series| slopes(&s.time, &velocity(s), half_width_s);
    let axes: [(&str, Column<'_>); 4] = [
        ("velocity", &velocity),
        ("position", &|s| s.position.clone()),
        ("input", &|s| s.input.clone()),
        ("acceleration", &acceleration),
    ];
    let others = axes
        .into_iter()
        .filter(|(axis, _)| !excluded.contains(axis));
    let scored = others.filter_map(|(axis, column)| {
        let bins = Bins::new(points(series, predictions, column), BINS)?;
        let stretch = bins.best(None)?;
        Some(Evidence {
            measured_by: MeasuredBy::WholeHorizon,
            ..Evidence::new(axis, bins, stretch, stretch.surplus())
        })
    });
    let best = scored.max_by(|a, b| a.strength.total_cmp(&b.strength))?;
    (best.strength > LEAST_SURPLUS).then_some(best)
}

/// The squared prediction error of each sample, with its coordinate from `column`.
fn points(series: &[Series], predictions: &[Vec<f64>], column: Column<'_>) -> Vec<Point> {
    let mut points = Vec::new();
    let mut block = 0;
    for (series, predicted) in series.iter().zip(predictions) {
        let at = column(series);
        for window in &series.windows {
            for i in window.samples.clone() {
                points.push(Point {
                    at: at[i],
                    index: points.len(),
                    block,
                    weight: 1.0,
                    excess: (series.position[i] - predicted[i]).powi(2),
                });
            }
            block += 1;
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::windows::series;

    #[test]
    fn an_error_that_grows_with_speed_lies_on_the_velocity_axis_unless_it_is_excluded() {
        let recording = made::recording(&[]);
        let half_width_s = recording.restart_half_width;
        let series = series::some_fine(&recording, recording.horizon, usize::MAX);
        let predicted = |s: &Series| {
            let velocity = slopes(&s.time, &s.position, half_width_s);
            let pairs = s.position.iter().zip(velocity);
            pairs.map(|(x, v)| x + 0.01 * v * v.abs()).collect()
        };
        let predictions: Vec<Vec<f64>> = series.iter().map(predicted).collect();
        let first = whole_horizon_axis(&series, &predictions, half_width_s, &[]).unwrap();
        assert_eq!(first.axis, "velocity");
        let other = whole_horizon_axis(&series, &predictions, half_width_s, &[first.axis]);
        assert!(other.is_none_or(|other| other.axis != "velocity"));
    }
}
