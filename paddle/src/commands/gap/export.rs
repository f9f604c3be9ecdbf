//! `paddle gap export`: converts a saved model to the format of a simulator.

use super::own_effects::OwnEffects;
use super::simulator::{self, Corrected};
use crate::answer::Answer;
use crate::device_file;
use crate::failure::Failure;
use crate::files;
use crate::targets::{Target, Use};
use clap::Args;
use export::Format;
use std::path::PathBuf;

/// Options of the export.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording --save-model corrected.toml
  paddle gap export corrected.toml mjcf --out paddle.xml
  python3 scripts/mujoco_gap.py my-recording paddle.xml     # the gap of the export, in MuJoCo
  paddle gap export corrected.toml console                  # friction and gravity compensation

What a format cannot express is named, here and at the head of the file. docs/export.md lists what each can.")]
pub struct Arguments {
    /// Model file that `paddle gap diagnose --save-model` wrote.
    model: PathBuf,
    /// Format of the simulator.
    #[arg(value_parser = simulator::format())]
    format: Format,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Write to this file [default: standard output].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The device moves linearly.
    #[arg(long)]
    linear: bool,
}

/// Exports the model.
///
/// # Errors
/// Returns a [`Failure`] if the model cannot be used or the file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.own_effects.add()?;
    let path = &arguments.model;
    let file = device_file::saved_model(path, None)?;
    let written = Corrected::of_file(&file, path, arguments.linear)?.written(arguments.format);
    let text = match &arguments.out {
        Some(out) => {
            files::leave(out, &written.exported.text)?;
            format!("{}model in {}\n", written.lacks(), out.display())
        }
        // The exported text contains the same remarks at its beginning.
        None => written.exported.text.clone(),
    };
    Ok(Answer {
        text,
        json: written.json(),
        problems: Vec::new(),
    })
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let model = Target::of("MODEL", Use::Read, &self.model);
        let out = Target::of("--out", Use::File, self.out.as_ref());
        [model, out].into_iter().flatten().collect()
    }
}
