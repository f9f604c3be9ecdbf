//! The firmware of this repository, built.

use crate::failure::Failure;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Builds it, which takes a moment if it is there already.
///
/// # Errors
/// [`Failure::Board`] if that does not work; cargo's own message stands above.
pub fn build() -> Result<PathBuf, Failure> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap_or(Path::new("."));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--package", "haptic-paddle"])
        .args(["--bin", "firmware", "--profile", "firmware"])
        .args(["--target", TARGET])
        .current_dir(root)
        .status();
    if !built.is_ok_and(|status| status.success()) {
        return Err(Failure::Board(
            "the firmware cannot be built here; give an image with --elf, or run `cargo xtask target`"
                .into(),
        ));
    }
    let folder = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root.join("target"), |folder| root.join(folder));
    Ok(folder.join(TARGET).join("firmware/firmware"))
}
