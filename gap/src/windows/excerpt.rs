//! Selects parts of a long recording, for methods that do not need all of it.

use super::restart;
use recording::{Recording, Run};
use std::borrow::Cow;
use std::ops::Range;

/// Number of windows of a part. The state that is carried from window to window needs some windows to settle.
const WINDOWS: f64 = 8.0;
/// Relative margin against rounding of a time.
const ROUNDING: f64 = 1e-6;

/// The recording itself, or parts of whole windows that are spread evenly over its runs, with about `most` rows in all. A part of a run
/// is a run with the same file name.
pub(crate) fn excerpt(recording: &Recording, most: usize) -> Cow<'_, Recording> {
    let rows: usize = recording.runs.iter().map(Run::len).sum();
    if rows <= most {
        return Cow::Borrowed(recording);
    }
    let share = most as f64 / rows as f64;
    let part_s = WINDOWS * recording.horizon;
    let parts = recording.runs.iter().flat_map(|run| {
        let parts = parts_of(run, share, part_s);
        parts.map(|rows| run.part(rows))
    });
    let runs = parts.filter(|part| part.len() >= restart::FEWEST).collect();
    Cow::Owned(recording.with_runs(runs))
}

/// Rows of the parts of a run that hold `share` of it. There is at least one part.
fn parts_of(run: &Run, share: f64, part_s: f64) -> impl Iterator<Item = Range<usize>> {
    let start_s = run.time.first().copied().unwrap_or(0.0);
    let count = (run.duration_s() / part_s).ceil().max(1.0) as usize;
    let kept = ((count as f64 * share).round() as usize).max(1);
    (0..kept).map(move |k| {
        let part = (2 * k + 1) * count / (2 * kept);
        let row_at = |parts: usize| {
            let at_s = start_s + (parts as f64 - ROUNDING) * part_s;
            run.time.partition_point(|time_s| *time_s < at_s)
        };
        row_at(part)..row_at(part + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn parts_of_a_long_recording_are_spread_over_all_of_it() {
        let recording = made::recording(&[]);
        let rows = |of: &Recording| of.runs.iter().map(Run::len).sum::<usize>();
        let whole = rows(&recording);
        assert_eq!(*excerpt(&recording, whole), recording);
        let most = whole / 4;
        let part = excerpt(&recording, most);
        let kept = rows(&part);
        assert!(
            (most / 2..=2 * most).contains(&kept),
            "{kept} of {whole}, not {most}"
        );
        for run in &recording.runs {
            let parts: Vec<_> = part
                .runs
                .iter()
                .filter(|part| part.file == run.file)
                .collect();
            assert!(!parts.is_empty(), "{} has no part", run.file);
            for pair in parts.windows(2) {
                assert!(pair[0].time.last() < pair[1].time.first(), "{}", run.file);
            }
        }
    }
}
