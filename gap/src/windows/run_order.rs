//! An order of runs that depends on their data alone.

use recording::{Recording, Run};
use std::borrow::Cow;

/// The recording with its runs by start, length and motion, and the place that each had. Which windows are held out depends on the
/// order of the runs; neither the order in the manifest, the names of the files nor the sign or unit of the position may change
/// that.
pub(crate) fn canonical(recording: &Recording) -> (Cow<'_, Recording>, Vec<usize>) {
    let mut places: Vec<usize> = (0..recording.runs.len()).collect();
    let keys: Vec<[f64; 4]> = recording.runs.iter().map(key).collect();
    places.sort_by(|&a, &b| {
        let pairs = keys[a].iter().zip(&keys[b]);
        pairs.fold(core::cmp::Ordering::Equal, |order, (a, b)| {
            order.then(a.total_cmp(b))
        })
    });
    if places.is_sorted() {
        return (Cow::Borrowed(recording), places);
    }
    let runs = places.iter().map(|&place| recording.runs[place].clone());
    let ordered = Recording {
        runs: runs.collect(),
        ..recording.clone()
    };
    (Cow::Owned(ordered), places)
}

/// Start, number of rows, mean square of the input, and that of the motion: a number that another unit or sign leaves in its order.
fn key(run: &Run) -> [f64; 4] {
    let mean_square = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let squares = values.iter().map(|v| (v - mean).powi(2));
        squares.sum::<f64>() / values.len().max(1) as f64
    };
    [
        run.time.first().copied().unwrap_or(0.0),
        run.len() as f64,
        mean_square(&run.input),
        mean_square(&run.position),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn runs_are_ordered_by_their_data_and_keep_their_places() {
        let recording = made::recording(&[]);
        let mut turned = recording.clone();
        turned.runs.reverse();
        let (ordered, places) = canonical(&turned);
        assert_eq!(ordered.runs, recording.runs);
        assert_eq!(places, [1, 0]);
        assert_eq!(canonical(&recording).1, [0, 1]);
    }
}
