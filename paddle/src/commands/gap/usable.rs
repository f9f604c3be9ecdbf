//! Recordings that can be worked with.

use crate::failure::Failure;
use crate::progress;
use gap::{Recording, inspected};
use std::path::Path;

/// Reads a recording whose columns mean what its model takes them for.
///
/// # Errors
/// [`Failure`] for a recording that cannot be read, or whose signs or units contradict its model.
pub fn read(folder: &Path) -> Result<Recording, Failure> {
    progress::begin();
    progress::doing("reading".into());
    let recording = Recording::read_watched(folder, &|share| progress::part_done(share))?;
    progress::doing("looking at signs and units".into());
    progress::begin();
    inspected(recording).map_err(|mistake| Failure::Unit {
        folder: folder.to_owned(),
        mistake,
    })
}
