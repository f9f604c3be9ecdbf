//! A recording without the stretches in which rows are missing.

use super::restart;
use recording::{Recording, Run};
use std::borrow::Cow;

/// A recording each of whose runs has all its rows.
pub(crate) struct Unbroken<'a> {
    /// Of which the runs are parts of those that were recorded.
    pub recording: Cow<'a, Recording>,
    /// The run that each is a part of.
    pub runs: Vec<usize>,
}

impl<'a> Unbroken<'a> {
    /// Cuts runs where rows are missing for longer than a restart looks to both sides: what was told in between nobody knows.
    /// Parts too short for a restart are left out.
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

/// First rows after the gaps that are longer.
fn cuts(run: &Run, longest_s: f64) -> Vec<usize> {
    let lasts = run.gaps().into_iter();
    let long = lasts.filter(|&last| run.time[last + 1] - run.time[last] > longest_s);
    long.map(|last| last + 1).collect()
}
