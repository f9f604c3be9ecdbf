//! Repeated rows: the position is logged more often than it is read.

use crate::statistics::{median, smallest_step};
use crate::{Oddity, Run};

/// Largest share of the changes that directly follow another change.
const NEXT_ROW: f64 = 0.05;
/// Least median change, over the smallest changes. A slow motion of a counter has equal changes.
const BEYOND_COUNTS: f64 = 2.0;
/// Fewest changes that show a pattern.
const FEWEST_CHANGES: usize = 20;

/// Returns the rows with a new position, if all other rows repeat the previous position.
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
    // At rest, a new reading can equal the previous one.
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
