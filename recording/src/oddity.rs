//! What is odd about a recording without spoiling it.

/// Something odd that was found and worked around, as one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Oddity {
    /// A key that nobody reads.
    #[error("recording.toml, line {line}: `{key}` in {table} is unknown and ignored{}", match nearest { Some(name) => format!("; was `{name}` meant?"), None => String::new() })]
    UnknownKey {
        /// Its line.
        line: usize,
        /// Its table.
        table: String,
        /// The key.
        key: String,
        /// What was probably meant.
        nearest: Option<&'static str>,
    },
    /// A position column about which nothing is stated.
    #[error("[sensor.{column}] is missing; the column is taken as continuous and free of noise")]
    SensorAssumed {
        /// The column.
        column: String,
    },
}
