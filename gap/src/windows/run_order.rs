//! A canonical order of the runs that depends only on their data.

use recording::{Recording, Run};
use std::borrow::Cow;

/// Sorts the runs by start, length, input and motion, and returns the original index of each. The order of the runs determines which
/// windows are held out. Thus the order in the manifest, the file names, and the sign or unit of the position cannot influence a result.
pub(crate) fn canonical(recording: &Recording) -> (Cow<'_, Recording>, Vec<usize>) {
    let mut indices: Vec<usize> = (0..recording.runs.len()).collect();
    let keys: Vec<[f64; 4]> = recording.runs.iter().map(key).collect();
    indices.sort_by(|&a, &b| {
        let pairs = keys[a].iter().zip(&keys[b]);
        pairs.fold(core::cmp::Ordering::Equal, |order, (a, b)| {
            order.then(a.total_cmp(b))
        })
    });
    if indices.is_sorted() {
        return (Cow::Borrowed(recording), indices);
    }
    let runs = indices.iter().map(|&index| recording.runs[index].clone());
    let ordered = Recording {
        runs: runs.collect(),
        ..recording.clone()
    };
    (Cow::Owned(ordered), indices)
}

/// Sort key of a run: start, number of rows, variance of the input, and variance of the position. Another unit or sign of the position
/// does not change the order of the variances.
fn key(run: &Run) -> [f64; 4] {
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let squares = values.iter().map(|v| (v - mean).powi(2));
        squares.sum::<f64>() / values.len().max(1) as f64
    };
    [
        run.time.first().copied().unwrap_or(0.0),
        run.len() as f64,
        variance(&run.input),
        variance(&run.position),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn runs_are_ordered_by_their_data_and_their_original_indices_are_returned() {
        let recording = made::recording(&[]);
        let mut reversed = recording.clone();
        reversed.runs.reverse();
        let (ordered, indices) = canonical(&reversed);
        assert_eq!(ordered.runs, recording.runs);
        assert_eq!(indices, [1, 0]);
        assert_eq!(canonical(&recording).1, [0, 1]);
    }
}
