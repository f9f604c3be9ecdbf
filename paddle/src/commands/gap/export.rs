//! `paddle gap export`: a saved model for the simulators that people use.

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

/// Which model, for what.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording --save-model corrected.toml
  paddle gap export corrected.toml mjcf --out paddle.xml
  python3 scripts/mujoco_gap.py my-recording paddle.xml     # the gap of the export, in MuJoCo
  paddle gap export corrected.toml console                  # friction and gravity compensation

What a format cannot express is named, here and at the head of the file. docs/export.md lists what each can.")]
pub struct Arguments {
    /// What `paddle gap diagnose --save-model` wrote.
    model: PathBuf,
    /// For which simulator.
    #[arg(value_parser = simulator::format())]
    format: Format,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Leave it here; without, it goes to standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The device slides rather than turns.
    #[arg(long)]
    linear: bool,
}

/// Exports.
///
/// # Errors
/// [`Failure`] for a model that cannot be used and a file that cannot be written.
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
        // The file has the same at its head.
        None => written.exported.text.clone(),
    };
    Ok(Answer {
        text,
        json: written.json(),
        amiss: Vec::new(),
    })
}

impl Arguments {
    /// Where it will write, and what it must not write over.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let model = Target::of("MODEL", Use::Read, &self.model);
        let out = Target::of("--out", Use::File, self.out.as_ref());
        [model, out].into_iter().flatten().collect()
    }
}
