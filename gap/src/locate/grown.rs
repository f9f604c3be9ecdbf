//! Where the gap has grown largest, wherever it has arisen.

use super::bins::{Bins, Point};
use super::evidence::{BINS, Evidence, LEAST_SURPLUS};
use crate::diagnosis::MeasuredBy;
use crate::windows::series::{Series, slopes};

/// A column of a series, one value a sample.
type Column<'a> = &'a dyn Fn(&Series) -> Vec<f64>;

/// The axis of the motion, other than what was `told`, along which what `predictions` over the whole horizon miss stands out
/// most; slopes are taken over `half_width_s` to either side. Over time a gap is uneven whatever its cause.
pub(super) fn grown(
    series: &[Series],
    predictions: &[Vec<f64>],
    half_width_s: f64,
    told: &[&str],
) -> Option<Evidence> {
    let velocity = move |s: &Series| slopes(&s.time, &s.position, half_width_s);
    let acceleration = move |s: &Series| slopes(&s.time, &velocity(s), half_width_s);
    let axes: [(&str, Column<'_>); 4] = [
        ("velocity", &velocity),
        ("position", &|s| s.position.clone()),
        ("input", &|s| s.input.clone()),
        ("acceleration", &acceleration),
    ];
    let others = axes.into_iter().filter(|(axis, _)| !told.contains(axis));
    let standing_out = others.filter_map(|(axis, column)| {
        let bins = Bins::new(points(series, predictions, column), BINS)?;
        let stretch = bins.best(None)?;
        Some(Evidence {
            measured_by: MeasuredBy::WholeHorizon,
            ..Evidence::new(axis, bins, stretch, stretch.surplus())
        })
    });
    let best = standing_out.max_by(|a, b| a.strength.total_cmp(&b.strength))?;
    (best.strength > LEAST_SURPLUS).then_some(best)
}

/// The squares of what is missed, sample by sample, along a column.
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
    fn what_grows_with_the_speed_is_told_of_the_velocity_unless_that_is_told_already() {
        let recording = made::recording(&[]);
        let half_width_s = recording.restart_half_width;
        let series = series::some_fine(&recording, recording.horizon, usize::MAX);
        let missed = |s: &Series| {
            let velocity = slopes(&s.time, &s.position, half_width_s);
            let missed = s.position.iter().zip(velocity);
            missed.map(|(x, v)| x + 0.01 * v * v.abs()).collect()
        };
        let predictions: Vec<Vec<f64>> = series.iter().map(missed).collect();
        let first = grown(&series, &predictions, half_width_s, &[]).unwrap();
        assert_eq!(first.axis, "velocity");
        let other = grown(&series, &predictions, half_width_s, &[first.axis]);
        assert!(other.is_none_or(|other| other.axis != "velocity"));
    }
}
