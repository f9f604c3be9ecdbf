//! Builds the firmware image on a host: the compiler target, the options, and the path of the image.

mod remap;
mod target;

pub use target::{TargetError, ensure};

use std::path::{Path, PathBuf};
use std::process::Command;

/// Rust target for the Cortex-M4 with a single-precision floating-point unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Cargo options that select the firmware.
const OPTIONS: [&str; 8] = [
    "--package",
    "haptic-paddle",
    "--bin",
    "firmware",
    "--profile",
    "firmware",
    "--target",
    TARGET,
];

/// The repository's root folder.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap_or(Path::new("."))
}

/// A command that runs the current cargo at the repository's root.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// A cargo command on the firmware, such as `build`. The image is independent of the folder and the user, because the
/// compiler writes no local path into it.
pub fn firmware(command: &str) -> Command {
    let mut cargo = cargo(&[command]);
    cargo.args(OPTIONS).envs(remap::flags());
    cargo
}

/// Path of the built image.
pub fn image_path() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root().join("target"), |folder| root().join(folder));
    folder.join(TARGET).join("firmware/firmware")
}
