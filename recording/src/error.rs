//! Why a recording cannot be used.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::actuator::NoRatio;
use crate::digits::short;

/// A fault of a recording: what is wrong, where, and how to correct it, in one line.
#[derive(Debug, thiserror::Error)]
pub struct Error {
    /// The file at fault.
    pub file: PathBuf,
    /// The line in the file, counted from 1, if there is one.
    pub line: Option<usize>,
    /// The fault. The message of the error includes it.
    pub fault: Box<Fault>,
}

impl Error {
    pub(crate) fn new(fault: Fault) -> Self {
        Self {
            file: PathBuf::new(),
            line: None,
            fault: Box::new(fault),
        }
    }

    pub(crate) fn at(mut self, line: Option<usize>) -> Self {
        self.line = line;
        self
    }

    pub(crate) fn in_file(mut self, file: &Path) -> Self {
        self.file = file.to_owned();
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}", self.fault)
    }
}

/// What is wrong with a file. The message names the cause and, after the semicolon, the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The operating system refused an access.
    #[error("cannot {doing}: {source}; {mend}")]
    Io {
        /// The attempted action.
        doing: &'static str,
        /// The error of the operating system.
        source: std::io::Error,
        /// The remedy.
        mend: &'static str,
    },
    /// The path is not a regular file.
    #[error("this is {found}; give a regular file")]
    NotAFile {
        /// What it is instead.
        found: &'static str,
    },
    /// The text is encoded with two bytes per character.
    #[error("the text is UTF-16; save it as UTF-8")]
    Utf16,
    /// The bytes are not UTF-8 text.
    #[error("the text is not UTF-8; save it as UTF-8")]
    NotUtf8,
    /// The text is not TOML, or a key is missing or has the wrong type.
    #[error("{message}; write it as docs/recording-format.md says")]
    Toml {
        /// The message of the parser.
        message: String,
    },
    /// The format has another version.
    #[error("format {found} is not known; this program reads `format = 1`")]
    Format {
        /// The stated version.
        found: String,
    },
    /// The key is unknown and would have no effect.
    #[error("{table} has no `{key}`; {}", match nearest { Some(name) => format!("write `{name}`"), None => format!("it knows {known}") })]
    UnknownKey {
        /// The table.
        table: String,
        /// The key in the file.
        key: String,
        /// The known key with the most similar name.
        nearest: Option<&'static str>,
        /// All keys of the table.
        known: String,
    },
    /// The number is outside its possible range.
    #[error("`{key}` is {value}; it must be {wanted}")]
    OutOfRange {
        /// Path of the key.
        key: String,
        /// The value in the file.
        value: String,
        /// The possible values.
        wanted: &'static str,
    },
    /// The manifest has no runs.
    #[error("there are no runs; add a [[runs]] table with `file` and `drive` for each CSV")]
    NoRuns,
    /// The file name leads out of the folder.
    #[error(
        "`{file}` leads out of the recording's folder; put the CSV into the folder and name it relative to that"
    )]
    Outside {
        /// The name in the manifest.
        file: String,
    },
    /// The CSV file has no samples.
    #[error("there is no sample; put a header line and one row per sample into it")]
    Empty,
    /// The cells are not separated by commas.
    #[error(
        "columns are separated by {found}; separate them by commas, with a point in decimals, or import the log by `paddle gap import` (docs/recording-format.md)"
    )]
    Delimiter {
        /// The separator that was found.
        found: &'static str,
    },
    /// The first line is a row of numbers.
    #[error(
        "the first line has numbers instead of names; add a header line such as `time,input,position`, or import the log by `paddle gap import` (docs/recording-format.md)"
    )]
    NoHeader,
    /// The first line is a comment.
    #[error(
        "the first line begins with `#`; remove the lines of comment, and the `#` in front of the names of the columns, or import the log by `paddle gap import` (docs/recording-format.md)"
    )]
    Comment,
    /// A required column is missing.
    #[error("column `{column}` is missing; {}", match similar { Some(name) => format!("rename `{name}` to `{column}`"), None => "add it, or import the log by `paddle gap import` (docs/recording-format.md)".to_owned() })]
    MissingColumn {
        /// The column.
        column: &'static str,
        /// A column with a similar name.
        similar: Option<String>,
    },
    /// Two columns have the same name.
    #[error("column `{column}` is there twice; rename or remove one of them")]
    DuplicateColumn {
        /// The column.
        column: String,
    },
    /// A row has more or fewer cells than the header.
    #[error(
        "the row has {found} cells where the header has {expected}; complete or remove the row"
    )]
    Ragged {
        /// Cells in the row.
        found: usize,
        /// Names in the header.
        expected: usize,
    },
    /// The cell is not a finite number.
    #[error("`{column}` is `{cell}`, not a finite number; correct the cell or remove the row")]
    Cell {
        /// The column.
        column: String,
        /// The text of the cell, shortened.
        cell: String,
    },
    /// The number is larger than any measured value.
    #[error(
        "`{column}` is `{cell}`, larger than anything that is measured; correct the cell or remove the row"
    )]
    TooLarge {
        /// The column.
        column: String,
        /// The text of the cell, shortened.
        cell: String,
    },
    /// The time does not increase.
    #[error("time goes from {before} s to {after} s; it must increase with every row: sort the rows, remove repeated ones, or split the run here", before = short(*before), after = short(*after))]
    TimeNotIncreasing {
        /// Time of the row before, s.
        before: f64,
        /// Time of this row, s.
        after: f64,
    },
    /// The CSV reader failed.
    #[error("{source}; write plain comma-separated text")]
    Csv {
        /// The message of the reader.
        source: csv::Error,
    },
    /// The run is shorter than one prediction window.
    #[error("the run lasts {duration_s} s, less than one horizon of {horizon} s; record longer, shorten `horizon`, or give time in s", duration_s = short(*duration_s), horizon = short(*horizon))]
    TooShort {
        /// Time from the first to the last sample, s.
        duration_s: f64,
        /// The manifest's horizon, s.
        horizon: f64,
    },
    /// The position never changes.
    #[error("`position` is {value} in every row; name the live column `position`, or leave the run out", value = short(*value))]
    Frozen {
        /// The only value.
        value: f64,
    },
    /// A prediction window has almost no samples.
    #[error("the median sample period is {period_s} s, too long for a horizon of {horizon} s; give `time` in s", period_s = short(*period_s), horizon = short(*horizon))]
    TimeUnit {
        /// Median time between rows, s.
        period_s: f64,
        /// The manifest's horizon, s.
        horizon: f64,
    },
    /// The model cannot produce the motion of the position.
    #[error("`position` does not fit [model]: {why}; give both in the same units, angles in rad")]
    PositionUnit {
        /// The deciding statistic, in words.
        why: String,
    },
    /// The input exceeds its stated limit by far.
    #[error("`input` is typically {typical} where `input_limit` is {limit}; give both in the same unit", typical = short(*typical))]
    InputUnit {
        /// Median magnitude of the non-zero inputs.
        typical: f64,
        /// The manifest's limit.
        limit: f64,
    },
    /// The model would move much farther than the position.
    #[error(
        "in one horizon [model] would move {spans:.0} times as far as `position` ever does; give `input`, `ratio` and `inertia` in matching units"
    )]
    ModelUnit {
        /// Distance of the model's motion over the span of the position.
        spans: f64,
    },
    /// A sensor table has no column.
    #[error("[sensor.{name}] belongs to no column of any run; {}", match nearest { Some(column) => format!("write [sensor.{column}]"), None => "remove it or add the column".to_owned() })]
    SensorWithoutColumn {
        /// Name of the table.
        name: String,
        /// A position column with a similar name.
        nearest: Option<String>,
    },
    /// In a recording made in memory, the columns have different lengths.
    #[error("column `{column}` has {found} samples where `time` has {expected}; fill it")]
    Length {
        /// The column.
        column: String,
        /// Number of its samples.
        found: usize,
        /// Number of samples of `time`.
        expected: usize,
    },
    /// Two runs have the same file name.
    #[error("two runs are called `{file}`; give each run its own file")]
    SameFile {
        /// The name.
        file: String,
    },
    /// Two tables define the actuator.
    #[error("{one} and {other} both define the actuator; leave one out")]
    SaidTwice {
        /// The first table.
        one: &'static str,
        /// The second table.
        other: &'static str,
    },
    /// The data sheet of the motor does not define the effect of the input.
    #[error(transparent)]
    Motor(#[from] NoRatio),
    /// The text cannot be written as TOML.
    #[error("{source}; correct the recording's text and numbers")]
    Unwritable {
        /// The message of the writer.
        source: toml::ser::Error,
    },
}
