//! Stretches of a long recording, for what does not need all of it.

use super::restart;
use recording::{Recording, Run};
use std::borrow::Cow;
use std::ops::Range;

/// Windows of a stretch, so that what is carried from window to window can settle.
const WINDOWS: f64 = 8.0;
/// Share of a time that rounding may take.
const HAIR: f64 = 1e-6;

/// The recording, or stretches of whole windows spread evenly over its runs, of about `most` rows in all. Stretches of a run
/// are runs that bear its name, as the parts of one in which rows are missing.
pub(crate) fn excerpt(recording: &Recording, most: usize) -> Cow<'_, Recording> {
    let rows: usize = recording.runs.iter().map(Run::len).sum();
    if rows <= most {
        return Cow::Borrowed(recording);
    }
    let share = most as f64 / rows as f64;
    let stretch_s = WINDOWS * recording.horizon;
    let parts = recording.runs.iter().flat_map(|run| {
        let stretches = stretches(run, share, stretch_s);
        stretches.map(|rows| run.part(rows))
    });
    let runs = parts.filter(|part| part.len() >= restart::FEWEST).collect();
    Cow::Owned(recording.with_runs(runs))
}

/// Rows of the stretches of a run that make up `share` of it, at least one.
fn stretches(run: &Run, share: f64, stretch_s: f64) -> impl Iterator<Item = Range<usize>> {
    let start_s = run.time.first().copied().unwrap_or(0.0);
    let count = (run.duration_s() / stretch_s).ceil().max(1.0) as usize;
    let kept = ((count as f64 * share).round() as usize).max(1);
    (0..kept).map(move |k| {
        let stretch = (2 * k + 1) * count / (2 * kept);
        let row_at = |stretches: usize| {
            let at_s = start_s + (stretches as f64 - HAIR) * stretch_s;
            run.time.partition_point(|time_s| *time_s < at_s)
        };
        row_at(stretch)..row_at(stretch + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn a_long_recording_is_looked_at_in_stretches_spread_over_all_of_it() {
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
            assert!(!parts.is_empty(), "{} is not looked at", run.file);
            for pair in parts.windows(2) {
                assert!(pair[0].time.last() < pair[1].time.first(), "{}", run.file);
            }
        }
    }
}
