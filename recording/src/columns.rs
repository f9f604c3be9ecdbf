//! Reads the columns of a CSV file.

use std::collections::BTreeMap;
use std::io::{BufReader, Read, Seek};
use std::str::FromStr;

use csv::{ByteRecord, Position, ReaderBuilder};

use crate::error::{Error, Fault};
use crate::keys;
use crate::text;

/// Largest number of characters of a bad cell that is quoted.
const QUOTED_CHARS: usize = 24;

/// Largest accepted number. Time in ns since 1970 is 1.8e18. The square of the limit does not overflow.
const LARGEST: f64 = 1e20;

/// The columns of a run, with the names of the format.
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
    /// Ignored columns whose cells never change.
    pub frozen: Vec<String>,
}

/// Destination of the cells of a column.
enum Sink {
    Wide(Vec<f64>),
    Narrow(Vec<f32>),
    /// The column is only checked for changes.
    Watched {
        first: Option<Vec<u8>>,
        changes: bool,
    },
}

impl Sink {
    fn of(column: &str) -> Self {
        match column {
            "time" | "input" | "position" | "setpoint" => Self::Wide(Vec::new()),
            "current" | "supply" | "temperature" => Self::Narrow(Vec::new()),
            further if further.starts_with("position_") => Self::Wide(Vec::new()),
            _ => Self::Watched {
                first: None,
                changes: false,
            },
        }
    }

    /// Frees unused capacity.
    fn shrink(&mut self) {
        match self {
            Self::Wide(column) => column.shrink_to_fit(),
            Self::Narrow(column) => column.shrink_to_fit(),
            Self::Watched { .. } => {}
        }
    }

    /// Stores a cell and returns its value. Returns `None` if the column needs a number and the cell is not a number of a
    /// possible size.
    fn push(&mut self, cell: &[u8]) -> Option<f64> {
        match self {
            Self::Wide(column) => {
                let value: f64 = number(cell)?;
                is_possible(value).then(|| column.push(value))?;
                Some(value)
            }
            Self::Narrow(column) => {
                let value: f32 = number(cell)?;
                is_possible(value.into()).then(|| column.push(value))?;
                Some(value.into())
            }
            Self::Watched { first, changes } => {
                if !*changes {
                    *changes = first.get_or_insert_with(|| cell.to_vec()) != cell;
                }
                Some(0.0)
            }
        }
    }
}

/// A fault, and the byte at which its row starts.
struct Found {
    fault: Fault,
    byte: Option<u64>,
}

impl From<Fault> for Found {
    fn from(fault: Fault) -> Self {
        Self { fault, byte: None }
    }
}

impl From<csv::Error> for Found {
    fn from(source: csv::Error) -> Self {
        Self {
            byte: source.position().map(Position::byte),
            fault: Fault::Csv { source },
        }
    }
}

/// Reads a whole CSV file.
///
/// # Errors
///
/// The first fault, with its line.
pub(crate) fn read(mut source: impl Read + Seek) -> Result<Columns, Error> {
    if is_utf16(&mut source).unwrap_or(false) {
        return Err(Error::new(Fault::Utf16));
    }
    parse(&mut source).map_err(|Found { fault, byte }| {
        Error::new(fault).at(byte.and_then(|byte| line_of_row(&mut source, byte).ok()))
    })
}

/// Returns true if the text is UTF-16. The position in the source is restored. Other errors are reported when the whole text
/// is read.
fn is_utf16(source: &mut (impl Read + Seek)) -> std::io::Result<bool> {
    let head = text::head(source)?;
    source.rewind()?;
    Ok(text::is_utf16(&head))
}

/// The line, from 1, of the row that starts at `byte`, or after the blank lines that follow it.
///
/// The CSV reader skips blank lines, so its own count would be wrong.
fn line_of_row(source: &mut (impl Read + Seek), byte: u64) -> std::io::Result<usize> {
    source.rewind()?;
    let mut line = 1;
    for (at, next) in (0..).zip(BufReader::new(source).bytes()) {
        match next? {
            b'\n' => line += 1,
            b'\r' => {}
            _ if at >= byte => break,
            _ => {}
        }
    }
    Ok(line)
}

fn parse(source: impl Read) -> Result<Columns, Found> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(source);
    let mut record = ByteRecord::new();
    let found = |fault: Fault, record: &ByteRecord| Found {
        fault,
        byte: record.position().map(Position::byte),
    };

    if !reader.read_byte_record(&mut record)? {
        return Err(Fault::Empty.into());
    }
    let names = header(&record).map_err(|fault| found(fault, &record))?;
    let mut sinks: Vec<Sink> = names.iter().map(|name| Sink::of(name)).collect();
    let time_column = names
        .iter()
        .position(|name| name == "time")
        .unwrap_or_default();

    let mut before = f64::NEG_INFINITY;
    while reader.read_byte_record(&mut record)? {
        if record.len() != names.len() {
            let fault = Fault::Ragged {
                found: record.len(),
                expected: names.len(),
            };
            return Err(found(fault, &record));
        }
        for (k, (sink, cell)) in sinks.iter_mut().zip(&record).enumerate() {
            let Some(value) = sink.push(cell) else {
                return Err(found(bad_cell(&names[k], cell), &record));
            };
            if k == time_column {
                if value <= before {
                    return Err(found(
                        Fault::TimeNotIncreasing {
                            before,
                            after: value,
                        },
                        &record,
                    ));
                }
                before = value;
            }
        }
    }
    if before == f64::NEG_INFINITY {
        return Err(Fault::Empty.into());
    }

    let mut columns = Columns::default();
    for (name, mut sink) in names.into_iter().zip(sinks) {
        sink.shrink();
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
            (_, sink) => {
                if matches!(sink, Sink::Watched { changes: false, .. }) {
                    columns.frozen.push(name.clone());
                }
                columns.ignored.push(name);
            }
        }
    }
    Ok(columns)
}

/// Why a cell cannot be used.
fn bad_cell(column: &str, cell: &[u8]) -> Fault {
    let column = column.to_owned();
    let is_too_large = number::<f64>(cell).is_some_and(f64::is_finite);
    let text = String::from_utf8_lossy(cell);
    let cell = text.chars().take(QUOTED_CHARS).collect();
    if is_too_large {
        Fault::TooLarge { column, cell }
    } else {
        Fault::Cell { column, cell }
    }
}

/// The names of the columns. The three that every run needs must be among them.
fn header(record: &ByteRecord) -> Result<Vec<String>, Fault> {
    let names: Vec<String> = record
        .iter()
        .map(|cell| String::from_utf8_lossy(cell).trim().to_owned())
        .collect();
    if names.first().is_some_and(|name| name.starts_with('#')) {
        return Err(Fault::Comment);
    }
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

fn is_possible(value: f64) -> bool {
    value.abs() <= LARGEST
}

fn number<T: FromStr>(cell: &[u8]) -> Option<T> {
    std::str::from_utf8(cell.trim_ascii()).ok()?.parse().ok()
}
