//! Splits runs at gaps in which rows are missing.

use super::restart;
use recording::{Recording, Run};
use std::borrow::Cow;

/// A recording whose runs have no gaps.
pub(crate) struct Unbroken<'a> {
    /// The recording whose runs are the parts between gaps.
    pub recording: Cow<'a, Recording>,
    /// Index of the recorded run of each part.
    pub runs: Vec<usize>,
}

impl<'a> Unbroken<'a> {
    /// Splits runs at gaps that are longer than the full width of a restart, because the input during a gap is unknown. Parts that are
    /// too short for a restart are left out.
    pub(crate) fn of(recording: &'a Recording) -> Self {
        let longest_s = 2.0 * recording.restart_half_width;
        let cuts = recording.runs.iter().map(|run| cuts(run, longest_s));
        let cuts: Vec<Vec<usize>> = cuts.collect();
        if cuts.iter().all(Vec::is_empty) {
            return Self {
                runs: (0..recording.runs.len()).collect(),
                recording: Cow::Borrowed(recording),
            };
        }
        let (mut runs, mut parts) = (Vec::new(), Vec::new());
        for (index, (run, cuts)) in recording.runs.iter().zip(&cuts).enumerate() {
            let starts = [0].iter().chain(cuts);
            let ends = cuts.iter().copied().chain([run.len()]);
            for (&start, end) in starts.zip(ends) {
                if end - start >= restart::FEWEST || cuts.is_empty() {
                    runs.push(index);
                    parts.push(run.part(start..end));
                }
            }
        }
        Self {
            recording: Cow::Owned(recording.with_runs(parts)),
            runs,
        }
    }
}

/// Index of the first row after each gap that is longer than `longest_s`.
fn cuts(run: &Run, longest_s: f64) -> Vec<usize> {
    let lasts = run.gaps().into_iter();
    let long = lasts.filter(|&last| run.time[last + 1] - run.time[last] > longest_s);
    long.map(|last| last + 1).collect()
}
