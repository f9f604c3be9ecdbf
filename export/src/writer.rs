//! The interface of the formats.

use crate::model::Model;
use crate::part::Part;

/// Writer of one format.
pub(crate) trait Writer {
    /// Returns true if the file contains the part exactly.
    fn expresses(&self, part: Part) -> bool;

    /// How the file approximates a part. `None` if it contains the part exactly or not at all.
    fn approximates(&self, _: Part) -> Option<&'static str> {
        None
    }

    /// The content of the file, with `notes` as comments at its beginning.
    fn text(&self, model: &Model, notes: &[String]) -> String;
}

/// The shortest text that is read back as the same number.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}
