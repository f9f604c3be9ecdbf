//! Builds the firmware of this repository.

use crate::failure::Failure;
use crate::progress;
use firmware_build::{ensure, firmware, image_path};
use std::path::PathBuf;

/// Builds the firmware; this is quick if the build is up to date. The function installs the compiler target if it is
/// missing, and prints a message before each long step.
///
/// # Errors
/// Returns [`Failure::Board`] if the build fails. Cargo prints its own message before that.
pub fn build() -> Result<PathBuf, Failure> {
    ensure(progress::note).map_err(|error| {
        Failure::Board(format!(
            "{error}; or give an image of the firmware with --elf"
        ))
    })?;
    let image = image_path();
    if !image.exists() {
        progress::note("building the firmware, once: this takes a minute or two");
    }
    let built = firmware("build").arg("--quiet").status();
    if built.is_ok_and(|status| status.success()) {
        return Ok(image);
    }
    Err(Failure::Board(
        "the firmware cannot be built here; correct the error above, or give an image with --elf"
            .into(),
    ))
}
