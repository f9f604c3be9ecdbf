//! Converts named arrays to columns.

use crate::log::{Column, Log};
use std::collections::BTreeMap;

/// An array as stored in a file.
pub(super) struct Array {
    pub name: String,
    pub shape: Vec<usize>,
    /// True if the array is stored column by column.
    pub is_by_columns: bool,
    pub values: Vec<f64>,
}

impl Array {
    /// Its columns if one of its dimensions is `rows`: one column for a vector, several for a matrix in either orientation.
    fn columns(&self, rows: usize) -> Vec<Column> {
        let shape: Vec<usize> = self
            .shape
            .iter()
            .copied()
            .filter(|size| *size != 1)
            .collect();
        match shape[..] {
            [count] if count == rows => {
                vec![Column::numbers(self.name.clone(), self.values.clone())]
            }
            [first, second] if first == rows || second == rows => {
                let stands = first == rows;
                let width = if stands { second } else { first };
                let at = |row: usize, column: usize| {
                    let (i, j) = if stands { (row, column) } else { (column, row) };
                    self.values[if self.is_by_columns {
                        i + j * first
                    } else {
                        i * second + j
                    }]
                };
                let column = |column| {
                    let cells = (0..rows).map(|row| at(row, column)).collect();
                    Column::numbers(format!("{}[{column}]", self.name), cells)
                };
                (0..width).map(column).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// A log of the arrays with the most common number of rows. Others are listed in its notes.
pub(super) fn log_of(arrays: Vec<Array>) -> Log {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for array in &arrays {
        let longest = array.shape.iter().copied().max().unwrap_or(0);
        *counts.entry(longest).or_default() += usize::from(longest > 1);
    }
    let most = counts
        .into_iter()
        .max_by_key(|(rows, count)| (*count, *rows));
    let rows = most.map_or(0, |(rows, _)| rows);
    let mut log = Log::default();
    for array in arrays {
        let is_whole = array.values.len() == array.shape.iter().product::<usize>();
        let columns = if is_whole {
            array.columns(rows)
        } else {
            Vec::new()
        };
        if columns.is_empty() {
            log.notes.push(format!(
                "array `{}` of shape {:?} has no {rows} rows and is left out",
                array.name, array.shape
            ));
        }
        log.columns.extend(columns);
    }
    log
}
