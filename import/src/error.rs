//! Why a log cannot be imported.

use std::path::PathBuf;

/// The fault in one line. The remedy follows after the semicolon.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The operating system refused to read the file.
    #[error("cannot read {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The reader of this format is not part of this build.
    #[error("{}: {format} needs a program built with `--features {feature}`; build it so, or export CSV", .path.display())]
    NotBuiltIn {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// Cargo feature that reads it.
        feature: &'static str,
    },
    /// The content of a binary file is not valid.
    #[error("{}: {why}; export it again, or as CSV", .path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The message of the reader.
        why: String,
    },
    /// The text has no table of numbers.
    #[error("{}: no rows of numbers were found; give a text with one row per sample, in columns", .path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// A row has another number of cells than the header.
    #[error("{}, line {line}: the row has {found} cells where the header has {expected}; check the delimiter, or quote cells that hold it", .path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Cells of the row.
        found: usize,
        /// Names in the header.
        expected: usize,
    },
    /// A requested column does not exist.
    #[error("{log}: there is no column `{name}`{}; its columns are {known}", match nearest { Some(near) => format!(" (was `{near}` meant?)"), None => String::new() })]
    NoColumn {
        /// The log.
        log: String,
        /// The requested name.
        name: String,
        /// A column with a similar name.
        nearest: Option<String>,
        /// All columns.
        known: String,
    },
    /// Several columns match a name.
    #[error("{log}: `{name}` may be any of {found}; write the whole name")]
    Ambiguous {
        /// The log.
        log: String,
        /// The requested name.
        name: String,
        /// The columns that match.
        found: String,
    },
    /// A formula is not valid.
    #[error(
        "formula `{text}`: {why}; write for instance '0.01*(sp-pos)/15', columns with odd names in braces: '2*{{q[2]}}'"
    )]
    Formula {
        /// The formula as written.
        text: String,
        /// What is wrong.
        why: String,
    },
    /// A role is not given and cannot be guessed from the names.
    #[error(
        "{log}: which column is the {role} cannot be told from the names; say so by `{option} NAME`, one of {known}"
    )]
    NotGuessed {
        /// The log.
        log: String,
        /// `time`, `input` or `position`.
        role: &'static str,
        /// The option that gives it.
        option: &'static str,
        /// Columns whose values change.
        known: String,
    },
    /// A column has text instead of numbers.
    #[error("{log}: column `{column}` holds text such as `{cell}`; choose a column of numbers")]
    Text {
        /// The log.
        log: String,
        /// The column.
        column: String,
        /// One of its cells.
        cell: String,
    },
    /// A column has the same value in all rows.
    #[error(
        "{log}: the position `{column}` is {value} in every row, as if it were not live; choose one that changes: {live}"
    )]
    Frozen {
        /// The log.
        log: String,
        /// The column.
        column: String,
        /// Its only value.
        value: f64,
        /// Columns whose values change.
        live: String,
    },
    /// The unit does not fit the quantity.
    #[error(
        "`{unit}` is no unit of {role}; write one such as {examples} after the name: 'NAME:UNIT'"
    )]
    Unit {
        /// The unit as written.
        unit: String,
        /// The quantity.
        role: &'static str,
        /// Examples of units of the quantity.
        examples: &'static str,
    },
    /// The position is in counts, and the counts per turn are not given.
    #[error("the position is in counts; say how many make a turn by --counts-per-turn N")]
    CountsPerTurn,
    /// A text is not a time.
    #[error(
        "{log}: `{cell}` in the time column `{column}` is no time; use numbers, or ISO 8601 such as 2026-01-02T03:04:05.678Z"
    )]
    Time {
        /// The log.
        log: String,
        /// The column.
        column: String,
        /// The cell.
        cell: String,
    },
    /// The data sheet of the motor does not define the effect of the input.
    #[error("{0} by --motor NAME=VALUE")]
    Motor(#[from] recording::NoRatio),
    /// An option contradicts the log or another option.
    #[error("{0}")]
    Option(String),
    /// No run remains of a log.
    #[error("{log}: no run of at least {rows} rows is left; {mend}")]
    NothingLeft {
        /// The log.
        log: String,
        /// Fewest rows of a run.
        rows: usize,
        /// The remedy.
        mend: &'static str,
    },
    /// The time of switching on a controller cannot be found.
    #[error(
        "{log}: the position never leaves its rest, so when the controller was switched on cannot be told; give the time by --on"
    )]
    NoSwitchOn {
        /// The log.
        log: String,
    },
    /// The imported recording is not valid.
    #[error(transparent)]
    Recording(#[from] recording::Error),
}
