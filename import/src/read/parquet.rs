//! Reads Parquet files: flat tables, and tables with lists of fixed length as LeRobot writes them.

use crate::log::{Cells, Column, Log};
use bytes::Bytes;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

/// Reads a table.
pub(super) fn read(bytes: Vec<u8>) -> Result<Log, String> {
    let failed = |error: parquet::errors::ParquetError| error.to_string();
    let reader = SerializedFileReader::new(Bytes::from(bytes)).map_err(failed)?;
    let mut building: Vec<(String, Building)> = Vec::new();
    for (at, row) in reader.get_row_iter(None).map_err(failed)?.enumerate() {
        for (name, field) in row.map_err(failed)?.get_column_iter() {
            add(name, field, at, &mut building);
        }
        for (_, cells) in &mut building {
            cells.fill(at + 1);
        }
    }
    let mut log = Log::default();
    log.columns.extend(
        building
            .into_iter()
            .map(|(name, cells)| Column::new(name, cells.finish())),
    );
    Ok(log)
}

/// A column that is being built.
struct Building {
    whole: Vec<Option<i64>>,
    numbers: Vec<f64>,
    text: Vec<String>,
    is_whole: bool,
    is_text: bool,
}

impl Building {
    /// A column whose first `rows` cells are empty.
    fn after(rows: usize) -> Self {
        let mut building = Self {
            whole: Vec::new(),
            numbers: Vec::new(),
            text: Vec::new(),
            is_whole: true,
            is_text: false,
        };
        building.fill(rows);
        building
    }

    /// Extends it to `rows` cells with empty ones.
    fn fill(&mut self, rows: usize) {
        while self.numbers.len() < rows {
            self.push(None, f64::NAN, String::new());
        }
    }

    fn push(&mut self, whole: Option<i64>, number: f64, text: String) {
        self.whole.push(whole);
        self.numbers.push(number);
        self.text.push(text);
    }

    fn finish(self) -> Cells {
        const EXACT: i64 = 1 << 53;
        let is_beyond = self.whole.iter().flatten().any(|whole| whole.abs() > EXACT);
        if self.is_text {
            Cells::Text(self.text)
        } else if self.is_whole && is_beyond {
            Cells::Whole(self.whole)
        } else {
            Cells::Numbers(self.numbers)
        }
    }
}

/// Adds a cell to the column `name`. Elements of a list or a group get columns of their own.
#[expect(clippy::cast_precision_loss, reason = "whole numbers are kept beside")]
fn add(name: &str, field: &Field, row: usize, building: &mut Vec<(String, Building)>) {
    match field {
        Field::ListInternal(list) => {
            for (at, element) in list.elements().iter().enumerate() {
                add(&format!("{name}[{at}]"), element, row, building);
            }
            return;
        }
        Field::Group(group) => {
            for (inner, field) in group.get_column_iter() {
                add(&format!("{name}.{inner}"), field, row, building);
            }
            return;
        }
        _ => {}
    }
    let at = building
        .iter()
        .position(|(other, _)| other == name)
        .unwrap_or_else(|| {
            building.push((name.to_owned(), Building::after(row)));
            building.len() - 1
        });
    let cells = &mut building[at].1;
    let mut whole = |value: i64| cells.push(Some(value), value as f64, String::new());
    match field {
        Field::Bool(value) => whole(i64::from(*value)),
        Field::Byte(value) => whole(i64::from(*value)),
        Field::Short(value) => whole(i64::from(*value)),
        Field::Int(value) | Field::Date(value) | Field::TimeMillis(value) => {
            whole(i64::from(*value))
        }
        Field::Long(value) | Field::TimeMicros(value) => whole(*value),
        Field::TimestampMillis(value) => whole(value.saturating_mul(1_000_000)),
        Field::TimestampMicros(value) => whole(value.saturating_mul(1000)),
        Field::UByte(value) => whole(i64::from(*value)),
        Field::UShort(value) => whole(i64::from(*value)),
        Field::UInt(value) => whole(i64::from(*value)),
        Field::ULong(value) => whole(i64::try_from(*value).unwrap_or(i64::MAX)),
        Field::Float(value) => {
            cells.is_whole = false;
            cells.push(None, f64::from(*value), String::new());
        }
        Field::Double(value) => {
            cells.is_whole = false;
            cells.push(None, *value, String::new());
        }
        Field::Str(value) => {
            cells.is_text = true;
            cells.push(None, f64::NAN, value.clone());
        }
        _ => cells.push(None, f64::NAN, String::new()),
    }
}
