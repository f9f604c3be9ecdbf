//! What each format has to say of itself.

use crate::model::Model;
use crate::part::Part;

/// One format.
pub(crate) trait Writer {
    /// Whether the part is in the file as it is.
    fn expresses(&self, part: Part) -> bool;

    /// How a part is in the file by another law; none if it is not or as it is.
    fn approximates(&self, _: Part) -> Option<&'static str> {
        None
    }

    /// The file, with `notes` as comments at its head.
    fn text(&self, model: &Model, notes: &[String]) -> String;
}

/// A number as short as reads back to the same.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}
