//! Reads text in columns.

use super::layout::{Delimiter, Layout, comment};
use super::number::{Decimal, is_nothing, number};
use crate::error::ImportError;
use crate::log::{Cells, Column, Log};
use std::path::Path;

/// Integers from here on are not exact as floats.
const EXACT: i64 = 1 << 53;
/// Least share of numbers among the non-empty cells of a numeric column.
const NUMBERS: f64 = 0.5;

/// Reads a text.
///
/// # Errors
///
/// [`ImportError::NoRows`] and [`ImportError::Ragged`].
pub(super) fn read(text: &str, path: &Path) -> Result<Log, ImportError> {
    let lines: Vec<&str> = text.lines().collect();
    let no_rows = || ImportError::NoRows {
        path: path.to_owned(),
    };
    let layout = Layout::of(&lines).ok_or_else(no_rows)?;
    let rows = Rows::of(&lines, &layout, path)?;
    let mut log = Log {
        notes: rows.notes,
        ..Log::default()
    };
    let names = layout.names.as_ref();
    for (at, cells) in rows.columns.into_iter().enumerate() {
        let named = names
            .and_then(|names| names.get(at))
            .map(|name| name.trim());
        let name = match named {
            Some(name) if !name.is_empty() => name.to_owned(),
            // A delimiter at the end of every line makes a column without name and content.
            _ if cells.is_empty() => continue,
            _ => format!("c{}", at + 1),
        };
        let (cells, lost) = cells.finish(layout.decimal);
        if lost > 0 {
            log.notes.push(format!(
                "{lost} cells of `{name}` are no numbers and count as empty"
            ));
        }
        let mut column = Column::new(name, cells);
        if let Some(unit) = layout.units.as_ref().and_then(|units| units.get(at)) {
            let bare = unit
                .trim()
                .trim_start_matches(['(', '['])
                .trim_end_matches([')', ']']);
            column.unit = Some(bare.trim().to_owned()).filter(|unit| !unit.is_empty());
        }
        log.columns.push(column);
    }
    if names.is_none() {
        log.notes
            .push("there is no header; the columns are called `c1`, `c2` and so on".into());
    }
    Ok(log)
}

/// Cells by column.
struct Rows {
    columns: Vec<Growing>,
    notes: Vec<String>,
}

impl Rows {
    fn of(lines: &[&str], layout: &Layout, path: &Path) -> Result<Self, ImportError> {
        // Comments and blank lines between the samples are skipped.
        let kept: Vec<usize> = (layout.first_row..lines.len())
            .filter(|&at| !lines[at].trim().is_empty() && comment(lines[at]).is_none())
            .collect();
        let mut body = String::new();
        for &at in &kept {
            match layout.delimiter {
                Delimiter::Byte(_) => body.push_str(lines[at]),
                Delimiter::Spaces => {
                    body.push_str(&super::layout::cells(lines[at], layout.delimiter).join("\t"))
                }
            }
            body.push('\n');
        }
        let delimiter = match layout.delimiter {
            Delimiter::Byte(byte) => byte,
            Delimiter::Spaces => b'\t',
        };
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .from_reader(body.as_bytes());
        let first = super::layout::cells(lines[layout.first_row], layout.delimiter).len();
        let width = layout
            .names
            .as_ref()
            .map_or(first, |names| names.len().max(first));
        let mut columns: Vec<Growing> = (0..width).map(|_| Growing::Unknown(0)).collect();
        let mut notes = Vec::new();
        let mut short = 0;
        let mut record = csv::StringRecord::new();
        let mut row = 0;
        loop {
            let malformed = |why: csv::Error| ImportError::Malformed {
                path: path.to_owned(),
                why: why.to_string(),
            };
            if !reader.read_record(&mut record).map_err(malformed)? {
                break;
            }
            let line = kept.get(row).map_or(0, |at| at + 1);
            row += 1;
            let is_last = row == kept.len();
            let filled = record.len()
                - record
                    .iter()
                    .rev()
                    .take_while(|cell| cell.is_empty())
                    .count();
            if filled > width {
                let (found, expected) = (filled, width);
                return Err(ImportError::Ragged {
                    path: path.to_owned(),
                    line,
                    found,
                    expected,
                });
            }
            if record.len() + 1 < width && is_last {
                notes.push(format!("the last line, {line}, is cut off and left out"));
                break;
            }
            short += usize::from(record.len() + 1 < width);
            for (at, column) in columns.iter_mut().enumerate() {
                column.push(record.get(at).unwrap_or_default(), layout.decimal);
            }
        }
        if short > 0 {
            notes.push(format!("{short} rows have fewer cells than there are columns; the missing ones count as empty"));
        }
        Ok(Self { columns, notes })
    }
}

/// A column that is being built. Its first non-empty cell determines its type.
enum Growing {
    /// Only empty cells so far. The value is their number.
    Unknown(usize),
    /// Numbers, and the number of cells that are not numbers.
    Numbers(Vec<f64>, usize),
    /// Integers that a float cannot hold exactly, and the number of cells that are not integers.
    Whole(Vec<Option<i64>>, usize),
    Text(Vec<String>),
}

impl Growing {
    fn push(&mut self, cell: &str, decimal: Decimal) {
        let empty = is_nothing(cell);
        let whole = || cell.trim().parse::<i64>().ok();
        if let Self::Unknown(count) = *self {
            if empty {
                *self = Self::Unknown(count + 1);
                return;
            }
            *self = if whole().is_some_and(|whole| whole.abs() > EXACT) {
                Self::Whole(vec![None; count], 0)
            } else if number(cell, decimal).is_some() {
                Self::Numbers(vec![f64::NAN; count], 0)
            } else {
                Self::Text(vec![String::new(); count])
            };
        }
        match self {
            Self::Numbers(cells, lost) => {
                let value = number(cell, decimal);
                *lost += usize::from(value.is_none() && !empty);
                cells.push(value.unwrap_or(f64::NAN));
            }
            Self::Whole(cells, lost) => {
                let value = whole();
                *lost += usize::from(value.is_none() && !empty);
                cells.push(value);
            }
            Self::Text(cells) => cells.push(cell.to_owned()),
            Self::Unknown(_) => {}
        }
    }

    /// True if all cells are empty.
    fn is_empty(&self) -> bool {
        matches!(self, Self::Unknown(_))
    }

    /// The cells with their final type, and the number of non-numbers in a numeric column.
    #[expect(clippy::cast_precision_loss, reason = "counts of cells")]
    fn finish(self, decimal: Decimal) -> (Cells, usize) {
        match self {
            Self::Unknown(count) => (Cells::Numbers(vec![f64::NAN; count]), 0),
            Self::Numbers(cells, lost) => (Cells::Numbers(cells), lost),
            Self::Whole(cells, lost) => (Cells::Whole(cells), lost),
            Self::Text(cells) => {
                // A word may precede the first number.
                let numbers: Vec<Option<f64>> =
                    cells.iter().map(|cell| number(cell, decimal)).collect();
                let filled = cells.iter().filter(|cell| !is_nothing(cell)).count();
                let count = numbers.iter().flatten().count();
                if (count as f64) < NUMBERS * filled as f64 {
                    return (Cells::Text(cells), 0);
                }
                let values = numbers.into_iter().map(|number| number.unwrap_or(f64::NAN));
                (Cells::Numbers(values.collect()), filled - count)
            }
        }
    }
}
