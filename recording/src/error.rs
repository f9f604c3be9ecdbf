//! Why a recording could not be used.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::actuator::NoRatio;
use crate::digits::short;

/// What is wrong with a recording, where, and how to mend it, in one line.
#[derive(Debug, thiserror::Error)]
pub struct Error {
    /// The file at fault.
    pub file: PathBuf,
    /// The line of the file, counted from 1 as an editor shows it, where there is one.
    pub line: Option<usize>,
    /// What is wrong; the message of the error has it all.
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

/// What is wrong with a file: the cause and, after the semicolon, the mend.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The file system refuses.
    #[error("cannot {doing}: {source}; {mend}")]
    Io {
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: std::io::Error,
        /// The mend.
        mend: &'static str,
    },
    /// What stands there is no regular file.
    #[error("this is {found}; give a regular file")]
    NotAFile {
        /// What it is.
        found: &'static str,
    },
    /// Text of two bytes a letter.
    #[error("the text is UTF-16; save it as UTF-8")]
    Utf16,
    /// Bytes that are no text.
    #[error("the text is not UTF-8; save it as UTF-8")]
    NotUtf8,
    /// Not TOML, or a key is missing or of the wrong kind.
    #[error("{message}; write it as docs/recording-format.md says")]
    Toml {
        /// What the parser said.
        message: String,
    },
    /// Another version of the format.
    #[error("format {found} is not known; this program reads `format = 1`")]
    Format {
        /// The stated version.
        found: String,
    },
    /// A key that would silently have no effect.
    #[error("{table} has no `{key}`; {}", match nearest { Some(name) => format!("write `{name}`"), None => format!("it knows {known}") })]
    UnknownKey {
        /// The table.
        table: String,
        /// The key in the file.
        key: String,
        /// What was probably meant.
        nearest: Option<&'static str>,
        /// All keys of the table.
        known: String,
    },
    /// A number that no device has.
    #[error("`{key}` is {value}; it must be {wanted}")]
    OutOfRange {
        /// Path of the key.
        key: String,
        /// The value in the file.
        value: String,
        /// What is possible.
        wanted: &'static str,
    },
    /// A manifest without runs.
    #[error("there are no runs; add a [[runs]] table with `file` and `drive` for each CSV")]
    NoRuns,
    /// A file name that leads out of the folder.
    #[error(
        "`{file}` leads out of the recording's folder; put the CSV into the folder and name it relative to that"
    )]
    Outside {
        /// The name in the manifest.
        file: String,
    },
    /// A CSV without a sample.
    #[error("there is no sample; put a header line and one row per sample into it")]
    Empty,
    /// Cells are separated by something else than commas.
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
    /// A column that every run needs is not there.
    #[error("column `{column}` is missing; {}", match similar { Some(name) => format!("rename `{name}` to `{column}`"), None => "add it, or import the log by `paddle gap import` (docs/recording-format.md)".to_owned() })]
    MissingColumn {
        /// The column.
        column: &'static str,
        /// A column with nearly its name.
        similar: Option<String>,
    },
    /// Two columns of one name.
    #[error("column `{column}` is there twice; rename or remove one of them")]
    DuplicateColumn {
        /// The column.
        column: String,
    },
    /// A row with more or fewer cells than the header.
    #[error(
        "the row has {found} cells where the header has {expected}; complete or remove the row"
    )]
    Ragged {
        /// Cells in the row.
        found: usize,
        /// Names in the header.
        expected: usize,
    },
    /// A cell that is not a finite number.
    #[error("`{column}` is `{cell}`, not a finite number; correct the cell or remove the row")]
    Cell {
        /// The column.
        column: String,
        /// The text of the cell, shortened.
        cell: String,
    },
    /// A number beyond everything that is measured.
    #[error(
        "`{column}` is `{cell}`, larger than anything that is measured; correct the cell or remove the row"
    )]
    TooLarge {
        /// The column.
        column: String,
        /// The text of the cell, shortened.
        cell: String,
    },
    /// Time goes back or repeats.
    #[error("time goes from {before} s to {after} s; it must increase with every row: sort the rows, remove repeated ones, or split the run here", before = short(*before), after = short(*after))]
    TimeNotIncreasing {
        /// Time of the row before, s.
        before: f64,
        /// Time of this row, s.
        after: f64,
    },
    /// The CSV reader gave up.
    #[error("{source}; write plain comma-separated text")]
    Csv {
        /// What the reader said.
        source: csv::Error,
    },
    /// The run is shorter than one prediction window.
    #[error("the run lasts {duration_s} s, less than one horizon of {horizon} s; record longer, shorten `horizon`, or give time in s", duration_s = short(*duration_s), horizon = short(*horizon))]
    TooShort {
        /// First to last sample, s.
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
    /// A prediction window holds hardly a sample.
    #[error("the median sample period is {period_s} s, too long for a horizon of {horizon} s; give `time` in s", period_s = short(*period_s), horizon = short(*horizon))]
    TimeUnit {
        /// Median time between rows, s.
        period_s: f64,
        /// The manifest's horizon, s.
        horizon: f64,
    },
    /// The position moves as no device of this model could.
    #[error("`position` does not fit [model]: {why}; give both in the same units, angles in rad")]
    PositionUnit {
        /// The statistic that decided.
        why: String,
    },
    /// The input lies far beyond the limit that is stated for it.
    #[error("`input` is typically {typical} where `input_limit` is {limit}; give both in the same unit", typical = short(*typical))]
    InputUnit {
        /// Median size of the input where it is not 0.
        typical: f64,
        /// The manifest's limit.
        limit: f64,
    },
    /// The model moves as no device would.
    #[error(
        "in one horizon [model] would move {spans:.0} times as far as `position` ever does; give `input`, `ratio` and `inertia` in matching units"
    )]
    ModelUnit {
        /// Distance over the span of the position.
        spans: f64,
    },
    /// A sensor table that belongs to no column.
    #[error("[sensor.{name}] belongs to no column of any run; {}", match nearest { Some(column) => format!("write [sensor.{column}]"), None => "remove it or add the column".to_owned() })]
    SensorWithoutColumn {
        /// Name of the table.
        name: String,
        /// A position column with nearly its name.
        nearest: Option<String>,
    },
    /// Columns of different lengths, in a recording made in memory.
    #[error("column `{column}` has {found} samples where `time` has {expected}; fill it")]
    Length {
        /// The column.
        column: String,
        /// Its samples.
        found: usize,
        /// Samples of `time`.
        expected: usize,
    },
    /// Two runs of one file.
    #[error("two runs are called `{file}`; give each run its own file")]
    SameFile {
        /// The name.
        file: String,
    },
    /// Two that say what a unit of input does.
    #[error("{one} and {other} both say what drives the joint; leave one out")]
    SaidTwice {
        /// One.
        one: &'static str,
        /// The other.
        other: &'static str,
    },
    /// A motor's data sheet that does not tell what the input does.
    #[error(transparent)]
    Motor(#[from] NoRatio),
    /// Text that cannot be put into TOML.
    #[error("{source}; correct the recording's text and numbers")]
    Unwritable {
        /// What the writer said.
        source: toml::ser::Error,
    },
}
