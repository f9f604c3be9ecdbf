//! Reads recordings that can be used.

use crate::failure::Failure;
use crate::progress;
use gap::{Recording, inspected};
use std::path::Path;

/// Reads a recording and checks that its columns agree with its model.
///
/// # Errors
/// Returns a [`Failure`] if the recording cannot be read, or if its signs or units contradict its model.
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
