//! How the firmware's image is built on a host: the compiler's target for it, the options, and where the image lies.

mod remap;
mod target;

pub use target::{TargetError, ensure};

use std::path::{Path, PathBuf};
use std::process::Command;

/// The compiler's name for the Cortex-M4 with single-precision floating-point unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Options of cargo that select the firmware.
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

/// A call of the cargo that runs this program, at the repository's root.
pub fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// A call of cargo on the firmware, as in `build`. The image is the same from any folder and for any user: the compiler writes no
/// path of this machine into it.
pub fn firmware(command: &str) -> Command {
    let mut cargo = cargo(&[command]);
    cargo.args(OPTIONS).envs(remap::flags());
    cargo
}

/// Where cargo puts the image.
pub fn image_path() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root().join("target"), |folder| root().join(folder));
    folder.join(TARGET).join("firmware/firmware")
}
