//! Splits a log into runs.

use crate::log::{Cells, Column};

/// Least length of a gap between runs, in usual periods. It must also be at least [`GAP_S`].
const GAP_PERIODS: f64 = 50.0;
/// Least length of a gap between runs, s.
const GAP_S: f64 = 1.0;
/// Least decrease of the time, over the elapsed time, that starts a new run. With a smaller one, rows are only out of order.
const ANEW: f64 = 0.5;

/// Rows of a run in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Span {
    pub rows: Vec<usize>,
    /// Value of the column that separates the runs.
    pub label: Option<String>,
}

/// The runs of rows with the times `seconds`. Rows without a time are left out. A run ends where the time restarts, where
/// `by` changes, and at gaps of `gap_s`. Without `gap_s` it ends at gaps that do not occur within one run.
pub(crate) fn spans(seconds: &[f64], by: Option<&Column>, gap_s: Option<f64>) -> Vec<Span> {
    let timed: Vec<usize> = (0..seconds.len())
        .filter(|row| !seconds[*row].is_nan())
        .collect();
    let mut spans: Vec<Span> = Vec::new();
    let least_s = gap_s.unwrap_or_else(|| GAP_S.max(GAP_PERIODS * usual_period(seconds, &timed)));
    let mut latest = f64::NEG_INFINITY;
    for &row in &timed {
        let label = by.map(|column| label(column, row));
        let passed_s = spans
            .last()
            .map_or(0.0, |span| latest - seconds[span.rows[0]]);
        let begins = match spans.last() {
            None => true,
            Some(span) => {
                span.label != label
                    || seconds[row] - latest > least_s
                    || (latest - seconds[row] > ANEW * passed_s && latest > seconds[row])
            }
        };
        if begins {
            spans.push(Span {
                rows: Vec::new(),
                label,
            });
            latest = seconds[row];
        }
        latest = latest.max(seconds[row]);
        spans.last_mut().expect("one was begun").rows.push(row);
    }
    for span in &mut spans {
        span.rows
            .sort_by(|a, b| seconds[*a].total_cmp(&seconds[*b]));
    }
    spans
}

fn usual_period(seconds: &[f64], rows: &[usize]) -> f64 {
    let steps = rows
        .windows(2)
        .map(|pair| seconds[pair[1]] - seconds[pair[0]]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

fn label(column: &Column, row: usize) -> String {
    match &column.cells {
        Cells::Numbers(cells) => cells[row].to_string(),
        Cells::Whole(cells) => cells[row].map_or_else(String::new, |whole| whole.to_string()),
        Cells::Text(cells) => cells[row].clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(spans: &[Span]) -> Vec<Vec<usize>> {
        spans.iter().map(|span| span.rows.clone()).collect()
    }

    #[test]
    fn runs_end_at_gaps_and_where_the_time_restarts() {
        let time = [0.0, 0.1, 0.2, 5.0, 5.1, 0.0, 0.1];
        assert_eq!(
            rows(&spans(&time, None, Some(1.0))),
            [vec![0, 1, 2], vec![3, 4], vec![5, 6]]
        );
        assert_eq!(
            rows(&spans(&time, None, None)),
            [vec![0, 1, 2, 3, 4], vec![5, 6]]
        );
    }

    #[test]
    fn rows_out_of_order_are_sorted() {
        let time = [0.0, 0.1, 0.3, 0.2, f64::NAN, 0.4];
        assert_eq!(rows(&spans(&time, None, None)), [vec![0, 1, 3, 2, 5]]);
    }

    #[test]
    fn a_column_separates_runs() {
        let by = Column::numbers("episode", vec![0.0, 0.0, 1.0, 1.0]);
        let found = spans(&[0.0, 0.1, 0.0, 0.1], Some(&by), None);
        assert_eq!(rows(&found), [vec![0, 1], vec![2, 3]]);
        assert_eq!(found[1].label.as_deref(), Some("1"));
    }
}
