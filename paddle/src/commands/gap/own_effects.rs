//! Effects that the user defines in files.

use crate::failure::Failure;
use clap::Args;
use gap::effects::add_own;
use std::path::{Path, PathBuf};

/// Files that define effects.
#[derive(Args)]
pub struct OwnEffects {
    /// Add the effect that this file defines to the library; may be repeated. The file states a torque as an expression of
    /// position, velocity, input and time, see docs/own-effects.md.
    #[arg(long = "effect", value_name = "FILE.toml")]
    files: Vec<PathBuf>,
}

impl OwnEffects {
    /// Adds the effects to the library of this process.
    ///
    /// # Errors
    /// Returns a [`Failure`] for a file that cannot be read or defines no effect.
    pub fn add(&self) -> Result<(), Failure> {
        self.files.iter().try_for_each(|path| add(path).map(drop))
    }
}

/// Adds the effect that a file defines to the library of this process, and returns the text of the file.
///
/// # Errors
/// Returns a [`Failure`] if the file cannot be read or defines no effect.
pub fn add(path: &Path) -> Result<String, Failure> {
    let text = std::fs::read_to_string(path).map_err(Failure::read(path))?;
    add_own(&text).map_err(|cause| Failure::OwnEffect {
        path: path.to_owned(),
        cause,
    })?;
    Ok(text)
}
