//! `paddle man`: writes a manual page for each command.

use crate::Cli;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::{Target, Use};
use clap::{Args, CommandFactory};
use serde_json::json;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Example:
  paddle man ~/.local/share/man/man1

Read them with `man paddle` or `man paddle-gap-diagnose`.")]
pub struct Arguments {
    /// Folder for the pages.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes the pages.
///
/// # Errors
/// Returns a [`Failure`] if the folder cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder).map_err(Failure::write(folder))?;
    clap_mangen::generate_to(Cli::command(), folder).map_err(Failure::write(folder))?;
    Ok(Answer {
        text: format!("manual pages in {}\n", folder.display()),
        json: json!({ "folder": folder }),
        ..Answer::default()
    })
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let folder = Target::of("DIR", Use::Folder, &self.folder);
        folder.into_iter().collect()
    }
}
