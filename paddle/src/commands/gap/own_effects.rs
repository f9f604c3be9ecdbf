//! Effects that a user writes down in files of his own.

use crate::failure::Failure;
use clap::Args;
use gap::effects::add_own;
use std::path::PathBuf;

/// Which files.
#[derive(Args)]
pub struct OwnEffects {
    /// Know the effect that this file defines as well: a torque as an expression of position, velocity, input and time, see
    /// docs/own-effects.md; may be repeated.
    #[arg(long = "effect", value_name = "FILE.toml")]
    files: Vec<PathBuf>,
}

impl OwnEffects {
    /// Adds them to the vocabulary of this program.
    ///
    /// # Errors
    /// [`Failure`] for a file that cannot be read or defines no effect.
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
