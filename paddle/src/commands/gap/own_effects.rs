//! Effects that the user defines in files.

use crate::failure::Failure;
use clap::Args;
use gap::effects::add_own;
use std::path::PathBuf;

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
        for path in &self.files {
            let text = std::fs::read_to_string(path).map_err(|source| Failure::Read {
                path: path.clone(),
                source,
            })?;
            add_own(&text).map_err(|cause| Failure::OwnEffect {
                path: path.clone(),
                cause,
            })?;
        }
        Ok(())
    }
}
