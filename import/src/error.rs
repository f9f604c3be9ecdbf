//! Why a log could not be imported.

use std::path::PathBuf;

/// What is wrong, and after the semicolon the mend, in one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file system refuses.
    #[error("cannot read {}: {source}; check the name", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A format of another program whose reader is not built in.
    #[error("{}: {format} needs a program built with `--features {feature}`; build it so, or export CSV", .path.display())]
    NotBuiltIn {
        /// The file.
        path: PathBuf,
        /// The format's name.
        format: &'static str,
        /// Cargo feature that reads it.
        feature: &'static str,
    },
    /// A binary file whose content cannot be understood.
    #[error("{}: {why}; export it anew, or as CSV", .path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What its reader said.
        why: String,
    },
    /// There is no table of numbers in the text.
    #[error("{}: no rows of numbers were found; give a text with one row per sample, in columns", .path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// Rows that do not fit the header.
    #[error("{}, line {line}: the row has {found} cells where the header has {expected}; check the delimiter, or quote cells that hold it", .path.display())]
    Ragged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Cells of the row.
        found: usize,
        /// Names in the header.
        expected: usize,
    },
    /// A column that is asked for is not there.
    #[error("{log}: there is no column `{name}`{}; its columns are {known}", match nearest { Some(near) => format!(" (was `{near}` meant?)"), None => String::new() })]
    NoColumn {
        /// The log.
        log: String,
        /// As asked for.
        name: String,
        /// A column with nearly that name.
        nearest: Option<String>,
        /// All columns.
        known: String,
    },
    /// A name that several columns have.
    #[error("{log}: `{name}` may be any of {found}; write the whole name")]
    Ambiguous {
        /// The log.
        log: String,
        /// As asked for.
        name: String,
        /// Columns that it may be.
        found: String,
    },
    /// A formula that cannot be understood.
    #[error(
        "formula `{text}`: {why}; write for instance '0.01*(sp-pos)/15', columns with odd names in braces: '2*{{q[2]}}'"
    )]
    Formula {
        /// As written.
        text: String,
        /// What is wrong.
        why: String,
    },
    /// Nobody said which column is what, and the names do not tell.
    #[error(
        "{log}: which column is the {role} cannot be told from the names; say so by `{option} NAME`, one of {known}"
    )]
    NotGuessed {
        /// The log.
        log: String,
        /// `time`, `input` or `position`.
        role: &'static str,
        /// Option that says it.
        option: &'static str,
        /// Columns that change.
        known: String,
    },
    /// Text where numbers are needed.
    #[error("{log}: column `{column}` holds text such as `{cell}`; choose a column of numbers")]
    Text {
        /// The log.
        log: String,
        /// The column.
        column: String,
        /// One of its cells.
        cell: String,
    },
    /// A column that repeats one value.
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
        /// Columns that change.
        live: String,
    },
    /// A unit that the quantity cannot have.
    #[error(
        "`{unit}` is no unit of {role}; write one such as {examples} after the name: 'NAME:UNIT'"
    )]
    Unit {
        /// As written.
        unit: String,
        /// What it was to be a unit of.
        role: &'static str,
        /// Units of that.
        examples: &'static str,
    },
    /// Counts without their number in a turn.
    #[error("the position is in counts; say how many make a turn by --counts-per-turn N")]
    CountsPerTurn,
    /// Text that is no time.
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
    /// A motor's data sheet that does not tell what the input does.
    #[error("{0} by --motor NAME=VALUE")]
    Motor(#[from] recording::NoRatio),
    /// An option that contradicts the log or another one.
    #[error("{0}")]
    Option(String),
    /// Nothing is left of a log.
    #[error("{log}: no run of at least {rows} rows is left; {mend}")]
    NothingLeft {
        /// The log.
        log: String,
        /// Least number of rows.
        rows: usize,
        /// What to do.
        mend: &'static str,
    },
    /// The switching-on of a controller shows nowhere.
    #[error(
        "{log}: the position never leaves its rest, so when the controller was switched on cannot be told; give the time by --on"
    )]
    NoSwitchOn {
        /// The log.
        log: String,
    },
    /// What was imported is no usable recording.
    #[error(transparent)]
    Recording(#[from] recording::Error),
}
