//! The columns of one CSV file, parsed straight into vectors.

use std::collections::BTreeMap;
use std::io::Read;

use csv::{ByteRecord, Position, ReaderBuilder};

use crate::error::{Error, Fault};
use crate::keys;

/// Longest piece of a bad cell that is quoted.
const QUOTED_CHARS: usize = 24;

/// The columns of a run, as the contract names them.
#[derive(Default)]
pub(crate) struct Columns {
    pub time: Vec<f64>,
    pub input: Vec<f64>,
    pub position: Vec<f64>,
    pub setpoint: Option<Vec<f64>>,
    pub positions: BTreeMap<String, Vec<f64>>,
    pub current: Option<Vec<f32>>,
    pub supply: Option<Vec<f32>>,
    pub temperature: Option<Vec<f32>>,
    pub ignored: Vec<String>,
}

/// Where a cell of a row goes.
enum Sink {
    Wide(Vec<f64>),
    Narrow(Vec<f32>),
    Nowhere,
}

/// Reads a whole CSV; `rows` is a guess of the number of rows.
///
/// # Errors
/// The first fault, with the line on which it stands.
pub(crate) fn read(source: impl Read, rows: usize) -> Result<Columns, Error> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(source);
    let mut record = ByteRecord::new();
    let mut lines = LineCount::default();

    if !lines.next(&mut reader, &mut record)? {
        return Err(Error::new(Fault::Empty));
    }
    let names = header(&record).map_err(|fault| Error::new(fault).at(Some(lines.row)))?;
    let mut sinks: Vec<Sink> = names
        .iter()
        .map(|name| match name.as_str() {
            "time" | "input" | "position" | "setpoint" => Sink::Wide(Vec::with_capacity(rows)),
            "current" | "supply" | "temperature" => Sink::Narrow(Vec::with_capacity(rows)),
            name if name.starts_with("position_") => Sink::Wide(Vec::with_capacity(rows)),
            _ => Sink::Nowhere,
        })
        .collect();
    let time_column = names
        .iter()
        .position(|name| name == "time")
        .unwrap_or_default();

    let mut before = f64::NEG_INFINITY;
    while lines.next(&mut reader, &mut record)? {
        let fail = |fault| Error::new(fault).at(Some(lines.row));
        if record.len() != names.len() {
            return Err(fail(Fault::Ragged {
                found: record.len(),
                expected: names.len(),
            }));
        }
        for (k, (sink, cell)) in sinks.iter_mut().zip(&record).enumerate() {
            if let Sink::Nowhere = sink {
                continue;
            }
            let value = number(cell).ok_or_else(|| {
                fail(Fault::Cell {
                    column: names[k].clone(),
                    cell: String::from_utf8_lossy(cell)
                        .chars()
                        .take(QUOTED_CHARS)
                        .collect(),
                })
            })?;
            if k == time_column {
                if value <= before {
                    return Err(fail(Fault::TimeNotIncreasing {
                        before,
                        after: value,
                    }));
                }
                before = value;
            }
            match sink {
                Sink::Wide(column) => column.push(value),
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "single precision is enough for these columns"
                )]
                Sink::Narrow(column) => column.push(value as f32),
                Sink::Nowhere => {}
            }
        }
    }
    if before == f64::NEG_INFINITY {
        return Err(Error::new(Fault::Empty));
    }

    let mut columns = Columns::default();
    for (name, sink) in names.into_iter().zip(sinks) {
        match (name.as_str(), sink) {
            ("time", Sink::Wide(column)) => columns.time = column,
            ("input", Sink::Wide(column)) => columns.input = column,
            ("position", Sink::Wide(column)) => columns.position = column,
            ("setpoint", Sink::Wide(column)) => columns.setpoint = Some(column),
            ("current", Sink::Narrow(column)) => columns.current = Some(column),
            ("supply", Sink::Narrow(column)) => columns.supply = Some(column),
            ("temperature", Sink::Narrow(column)) => columns.temperature = Some(column),
            (_, Sink::Wide(column)) => {
                columns.positions.insert(name, column);
            }
            _ => columns.ignored.push(name),
        }
    }
    Ok(columns)
}

/// The names of the columns, with the three that every run needs.
fn header(record: &ByteRecord) -> Result<Vec<String>, Fault> {
    let names: Vec<String> = record
        .iter()
        .map(|cell| String::from_utf8_lossy(cell).trim().to_owned())
        .collect();
    if let [only] = names.as_slice() {
        let separators = [
            (';', "semicolons"),
            ('\t', "tabs"),
            ('|', "bars"),
            (' ', "spaces"),
        ];
        if let Some((_, found)) = separators
            .into_iter()
            .find(|(separator, _)| only.contains(*separator))
        {
            return Err(Fault::Delimiter { found });
        }
    }
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(Fault::NoHeader);
    }
    for (k, name) in names.iter().enumerate() {
        if !name.is_empty() && names[..k].contains(name) {
            return Err(Fault::DuplicateColumn {
                column: name.clone(),
            });
        }
    }
    for column in ["time", "input", "position"] {
        if !names.iter().any(|name| name == column) {
            let similar = names
                .iter()
                .find(|name| keys::nearest(name, [column]).is_some());
            return Err(Fault::MissingColumn {
                column,
                similar: similar.cloned(),
            });
        }
    }
    Ok(names)
}

/// A finite number.
fn number(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell.trim_ascii()).ok()?;
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Counts the lines of the rows: the reader skips blank lines without saying on which line a row then stands.
#[derive(Default)]
struct LineCount {
    row: usize,
}

impl LineCount {
    /// Reads the next row and notes its line; `false` at the end of the file.
    fn next<R: Read>(
        &mut self,
        reader: &mut csv::Reader<R>,
        record: &mut ByteRecord,
    ) -> Result<bool, Error> {
        let more = reader.read_byte_record(record).map_err(|source| {
            let line = source
                .position()
                .map(|at| usize::try_from(at.line()).unwrap_or(usize::MAX));
            Error::new(Fault::Csv { source }).at(line)
        })?;
        self.row =
            usize::try_from(record.position().map_or(1, Position::line)).unwrap_or(usize::MAX);
        Ok(more)
    }
}
