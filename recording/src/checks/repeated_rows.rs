//! A position that is read less often than it is logged.

use crate::statistics::{median, smallest_step};
use crate::{Oddity, Run};

/// Repeated: fewer changes than this share follow one another from row to row.
const NEXT_ROW: f64 = 0.05;
/// And most of them are this many times the smallest ones, so that it is no counter that the device is slow for.
const BEYOND_COUNTS: f64 = 2.0;
/// Fewest changes that tell a pattern.
const FEWEST_CHANGES: usize = 20;

/// The rows in which the position is new, where the others repeat the one before: it is read less often than it is logged.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
pub(crate) fn fresh_rows(run: &Run) -> Option<(Oddity, Vec<usize>)> {
    let x = &run.position;
    let changes: Vec<usize> = (1..x.len()).filter(|&row| x[row] != x[row - 1]).collect();
    if changes.len() < FEWEST_CHANGES {
        return None;
    }
    let apart = || changes.windows(2).map(|pair| pair[1] - pair[0]);
    let next_row = apart().filter(|rows| *rows == 1).count() as f64;
    let steps = changes.iter().map(|&row| (x[row] - x[row - 1]).abs());
    if next_row > NEXT_ROW * changes.len() as f64
        || median(steps.collect()) < BEYOND_COUNTS * smallest_step(x)
    {
        return None;
    }
    let mut apart: Vec<usize> = apart().collect();
    let middle = apart.len() / 2;
    let every = *apart.select_nth_unstable(middle).1;
    // At rest what is new is the same.
    let mut fresh = vec![0];
    for row in 1..x.len() {
        let last = fresh[fresh.len() - 1];
        if x[row] != x[row - 1] || row - last >= every {
            fresh.push(row);
        }
    }
    let oddity = Oddity::Repeated {
        file: run.file.clone(),
        every,
    };
    Some((oddity, fresh))
}
