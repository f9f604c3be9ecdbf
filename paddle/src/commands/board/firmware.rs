//! The firmware of this repository, built.

use crate::failure::Failure;
use crate::progress;
use firmware_build::{ensure, firmware, image_path};
use std::path::PathBuf;

/// Builds it, which takes a moment if it is there already. The compiler's target is installed if it is not there; what takes
/// long is told beforehand.
///
/// # Errors
/// [`Failure::Board`] if that does not work; cargo's own message stands above.
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
        "the firmware cannot be built here; mend what stands above, or give an image with --elf"
            .into(),
    ))
}
