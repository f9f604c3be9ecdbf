//! Jumps of an encoder count: steps between two samples that no motion causes.

use crate::columns::Disagreement;
use crate::guess::Evidence;
use crate::guess::start::linear;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::statistics::quantile;
use host_sim::effects::lost_counts::KIND;
use recording::low_pass_gain;

/// Least size of a jump, over the spread of the steps of the motion and over the noise.
const STEP_RATIO: f64 = 12.0;
/// The 0.75 quantile of |N(0, 1)|, over its standard deviation.
const UPPER_QUARTILE: f64 = 1.15;
/// Share of the largest neighbouring step from which a step counts as equally large.
const EQUAL_SHARE: f64 = 0.8;
/// Largest number of jumps. More jumps are noise or motion, except for those that are larger than the next by the factor [`OUTSTANDING`].
const MOST_JUMPS: usize = 40;
const OUTSTANDING: f64 = 3.0;
/// Largest number of jumps whose instants are fitted. With more jumps only the heights are fitted.
const MOST_TIMED: usize = 12;
/// Largest number of jumps between two position columns.
const MOST_IN_COLUMNS: usize = 12;
/// Least reduction of the sum of squares by a jump between two columns, in noise variances, and its least height, in standard deviations.
const JUMP_GAIN: f64 = 40.0;
const JUMP_HEIGHT: f64 = 3.0;
/// Least height of a jump between two columns, as a share of the highest jump.
const LEAST_JUMP: f64 = 0.1;
/// Least number of samples between two jumps. In a column with a lag, a controller that reacts to a jump causes a further error.
const SAMPLES_APART: usize = 10;
/// Largest number of jumps that are searched in the missing torque, and the least number of rows between two of them. The first rows of a
/// stretch are excluded because the smoother has not converged there.
const JUMPS_SCREENED: usize = 3;
const ROWS_APART: usize = 20;
const FIRST_ROWS: usize = 10;

/// Starts with all jumps that were found, each with its instant and height. Returns none without a jump.
pub(super) fn starts(e: &Evidence<'_>) -> Vec<Term> {
    let mut jumps = Vec::new();
    for series in e.series {
        let x = &series.position;
        // Deviation of the step to a sample from the mean slope of its neighbours.
        let breaks: Vec<f64> = (0..x.len())
            .map(|i| {
                if i < 2 || i + 1 >= x.len() {
                    return 0.0;
                }
                let slope = |a: usize, b: usize| (x[b] - x[a]) / (series.time[b] - series.time[a]);
                let dt = series.time[i] - series.time[i - 1];
                let before = slope(i - 2, i - 1);
                let after = slope(i, i + 1);
                (x[i] - x[i - 1]) - 0.5 * (before + after) * dt
            })
            .collect();
        let sizes: Vec<f64> = breaks.iter().map(|b| b.abs()).collect();
        let spread = (quantile(&sizes, 0.75) / UPPER_QUARTILE).max(e.scales.noise);
        for (i, height) in breaks.iter().enumerate() {
            // A step also changes the neighbouring deviations, so only the largest one counts.
            let near = i.saturating_sub(2)..(i + 3).min(sizes.len());
            let largest = near.clone().all(|k| sizes[k] <= height.abs());
            if largest && height.abs() > STEP_RATIO * spread {
                // If a jump lies within an averaged sample, the steps to both neighbours are equally large. The samples around them then
                // show the full height.
                let tied = near.filter(|&k| sizes[k] >= EQUAL_SHARE * height.abs());
                let whole = tied.filter_map(|k| Some((k, height_around(&series.time, x, k)?)));
                let whole = whole.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                let (i, height) = whole.unwrap_or((i, *height));
                jumps.push((series.session(i - 1), series.session(i), height));
            }
        }
    }
    jumps.dedup_by_key(|jump| jump.0);
    let jumps = outstanding(jumps);
    if jumps.is_empty() {
        return Vec::new();
    }
    // The count may also be reset at the begin of every run.
    let mut reset_per_run = Vec::new();
    for (index, series) in e.series.iter().enumerate() {
        let Some([from, to]) = series.session_span_s() else {
            continue;
        };
        let within = |j: &Found| (from..=to).contains(&j.0);
        let in_run: Vec<_> = jumps.iter().copied().filter(within).collect();
        let sum: f64 = in_run.iter().map(|j| j.2).sum();
        reset_per_run.extend(in_run);
        let mut next = e.series[index + 1..].iter().filter(|s| !s.time.is_empty());
        if let Some(next) = next.next().filter(|_| sum != 0.0) {
            let start = next.session(0) - 0.5 * next.span_s;
            reset_per_run.push((start, start, -sum));
        }
    }
    // Behind a low-pass the first sample after a jump shows only a part of the height.
    let shown_share = low_pass_gain(e.cutoff_hz, e.series[0].period_s.max(e.series[0].span_s));
    let parts = if shown_share < 1.0 {
        &[1.0, shown_share][..]
    } else {
        &[1.0]
    };
    let terms = parts
        .iter()
        .flat_map(|part| [&jumps, &reset_per_run].map(|jumps| term(jumps, *part)));
    terms.collect()
}

/// A jump that was found: the first and the last instant that it may have, s of the session, and its height.
type Found = (f64, f64, f64);

/// All jumps, or if they are too many, those that are much larger than the others.
fn outstanding(jumps: Vec<Found>) -> Vec<Found> {
    if jumps.len() <= MOST_JUMPS {
        return jumps;
    }
    let mut sizes: Vec<f64> = jumps.iter().map(|jump| jump.2.abs()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let falls = sizes.windows(2).take(MOST_JUMPS);
    let steepest = falls.max_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
    let least = steepest.filter(|fall| fall[0] > OUTSTANDING * fall[1]);
    let least = least.map_or(f64::INFINITY, |fall| fall[0]);
    let large = jumps.into_iter().filter(|jump| jump.2.abs() >= least);
    large.collect()
}

/// Height of a jump between samples `i − 1` and `i`, from the samples around them. An averaged sample may show only a part of the height.
fn height_around(time: &[f64], x: &[f64], i: usize) -> Option<f64> {
    let (a, b) = (i.checked_sub(2)?, i + 1);
    let slope =
        |from: usize, to: usize| Some((x.get(to)? - x[from]) / (time.get(to)? - time[from]));
    let motion = 0.5 * (slope(a.checked_sub(2)?, a)? + slope(b, b + 2)?);
    Some(x[b] - x[a] - motion * (time[b] - time[a]))
}

/// A term of jumps. Each lies between two instants, or at one, and has a height of which only the share `part` is seen.
fn term(jumps: &[Found], part: f64) -> Term {
    let jumps = jumps
        .iter()
        .map(|&(before, after, height)| (before, after, height / part));
    let mut free = Vec::new();
    let is_timed = jumps.len() <= MOST_TIMED;
    for (index, (before, after, height)) in jumps.clone().enumerate() {
        let place = KIND.event_place(index);
        // Within an averaged sample the instant determines the value of the sample, so it can be fitted.
        if is_timed && after > before {
            free.push(linear(
                place,
                0.5 * (before + after),
                0.5 * (after - before),
            ));
        }
        free.push(linear(place + 1, height, 0.5 * height.abs()));
    }
    let events = jumps.map(|(before, after, height)| [0.5 * (before + after), height]);
    Term {
        kind: &KIND,
        values: KIND.events(&events.collect::<Vec<_>>()),
        free,
        sensor_on_load: false,
    }
}

/// Time and height of each step between stretches on which the disagreement is constant, by binary
/// segmentation (Scott and Knott, Biometrics 30, 1974).
pub(super) fn between_columns(columns: &Disagreement<'_>) -> Option<Vec<f64>> {
    let tracks = &columns.columns.tracks;
    let times: Vec<f64> = tracks.iter().flat_map(|t| &t.session_s).copied().collect();
    let mut sums = vec![0.0];
    for difference in &columns.difference {
        sums.push(sums[sums.len() - 1] + difference);
    }
    let total = |from: usize, to: usize| (sums[to] - sums[from], (to - from) as f64);
    let variance = columns.columns.variance;
    // Height and index of the next jump, unless it is noise.
    let next = |edges: &[usize]| {
        let splits = edges.windows(2).flat_map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            (from + SAMPLES_APART..(to + 1).saturating_sub(SAMPLES_APART))
                .map(move |at| (from, at, to))
        });
        let gains = splits.map(|(from, at, to)| {
            let ((a, n), (b, m)) = (total(from, at), total(at, to));
            let height = b / m - a / n;
            (height * height * n * m / (n + m), height, at)
        });
        let (gain, height, at) = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_noise =
            gain < JUMP_GAIN * variance || height.powi(2) < JUMP_HEIGHT.powi(2) * variance;
        (!is_noise).then_some((height, at))
    };
    let mut edges = vec![0, times.len()];
    let mut further = next(&edges);
    while let Some((_, at)) = further.filter(|_| edges.len() < MOST_IN_COLUMNS + 2) {
        edges.push(at);
        edges.sort_unstable();
        further = next(&edges);
    }
    // Level before each jump, and its height.
    let steps = |edges: &[usize]| -> Vec<(usize, f64, f64)> {
        let steps = edges.windows(3).map(|edge| {
            let ((a, n), (b, m)) = (total(edge[0], edge[1]), total(edge[1], edge[2]));
            (edge[1], a / n, b / m - a / n)
        });
        steps.collect()
    };
    let all = steps(&edges);
    let highest = all.iter().fold(0.0f64, |high, step| high.max(step.2.abs()));
    let is_small = |height: f64| height.abs() < LEAST_JUMP * highest;
    if further.is_some_and(|(height, _)| !is_small(height)) {
        return None;
    }
    let small = all.iter().filter(|step| is_small(step.2));
    for (at, ..) in small {
        edges.retain(|edge| edge != at);
    }
    let timed = |(at, level, height): (usize, f64, f64)| {
        // The value of an averaged sample shows at which instant within it the jump occurred.
        let share = |i: usize| ((columns.difference[i] - level) / height).clamp(0.0, 1.0);
        let share_before = 1.5 - share(at - 1) - share(at);
        [
            times[at - 1] + share_before * (times[at] - times[at - 1]),
            height,
        ]
    };
    let steps: Vec<_> = steps(&edges).into_iter().map(timed).collect();
    (!steps.is_empty()).then(|| KIND.events(&steps))
}

/// Forms with jumps at the largest innovations of the smoother: the largest one, the two largest, and so on.
pub(super) fn torque_forms(path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
    let n = path.position.len();
    let found = largest_innovations(path, target);
    let unit = 0.1 * path.scale.half_span();
    let column = |row: usize| -> Vec<f64> {
        let end = path
            .samples
            .stretches
            .iter()
            .find(|s| s.rows.contains(&row));
        let end = end.map_or(n, |s| s.rows.end);
        let rows = 0..n;
        rows.map(|i| if (row..end).contains(&i) { unit } else { 0.0 })
            .collect()
    };
    let forms = (1..=found.len()).map(|count| {
        let rows = &found[..count];
        let at_s: Vec<f64> = rows
            .iter()
            .map(|&row| path.samples.session_s[row])
            .collect();
        let form = Form::new(vec![vec![0.0; n]; count], move |c| {
            let mut values = with_defaults(&KIND, &[(0, at_s[0]), (1, unit * c[0]), (2, 0.0)]);
            for (at_s, c) in at_s.iter().zip(c).skip(1) {
                values.extend([*at_s, unit * c]);
            }
            values
        });
        Form {
            reading: rows.iter().map(|&row| column(row)).collect(),
            ..form.searched(count).seldom()
        }
    });
    forms.collect()
}

/// The rows with the largest innovations, at least [`ROWS_APART`] rows apart.
fn largest_innovations(path: &Path<'_>, target: &Target<'_>) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..path.position.len()).collect();
    for stretch in &path.samples.stretches {
        let first = stretch.rows.start..(stretch.rows.start + FIRST_ROWS).min(stretch.rows.end);
        rows.retain(|row| !first.contains(row));
    }
    let size = |row: usize| target.innovation[row].abs();
    let mut found: Vec<usize> = Vec::new();
    while found.len() < JUMPS_SCREENED {
        let far = |row: usize| found.iter().all(|f: &usize| f.abs_diff(row) > ROWS_APART);
        let next = rows.iter().copied().filter(|&row| far(row));
        let Some(row) = next.max_by(|a, b| size(*a).total_cmp(&size(*b))) else {
            break;
        };
        found.push(row);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_many_jumps_only_the_heights_are_fitted() {
        let fitted = |count: usize| {
            let jumps = (0..count).map(|k| (k as f64, k as f64 + 1e-3, 0.1));
            let jumps: Vec<Found> = jumps.collect();
            term(&jumps, 1.0).free.len()
        };
        assert_eq!(fitted(MOST_TIMED), 2 * MOST_TIMED);
        assert_eq!(fitted(MOST_JUMPS), MOST_JUMPS);
    }

    #[test]
    fn only_jumps_that_stand_out_from_the_steps_of_the_motion_are_kept() {
        let steps = |count: u32, height: f64| (0..count).map(move |k| (f64::from(k), 0.5, height));
        let motion: Vec<Found> = steps(MOST_JUMPS as u32 + 1, 0.04).collect();
        let with = |jumps: &[Found]| outstanding([jumps, &motion].concat());
        assert_eq!(with(&[]), []);
        let two = [(61.0, 0.5, -0.7), (62.0, 0.5, 0.6)];
        assert_eq!(with(&two), two);
        let few: Vec<Found> = steps(5, 0.04).chain(two).collect();
        assert_eq!(outstanding(few.clone()), few);
    }
}
