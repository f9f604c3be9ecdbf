//! `paddle gap export`: a saved model for the simulators that people use.

use super::own_effects::OwnEffects;
use crate::answer::Answer;
use crate::device_file;
use crate::failure::Failure;
use crate::files;
use crate::targets::{Target, Use};
use clap::{Args, ValueEnum};
use export::{Exported, Format, Model, exported};
use serde_json::json;
use std::path::PathBuf;

/// Which model, for what.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap diagnose my-recording --save-model corrected.toml
  paddle gap export corrected.toml mjcf --out paddle.xml
  python3 scripts/mujoco_gap.py my-recording paddle.xml     # the gap of the export, in MuJoCo
  paddle gap export corrected.toml console                  # friction and gravity compensation

What a format cannot express is named, here and at the head of the file. docs/export.md has the equations.")]
pub struct Arguments {
    /// What `paddle gap diagnose --save-model` wrote.
    model: PathBuf,
    /// For which simulator.
    #[arg(value_enum)]
    format: For,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Leave it here; without, it goes to standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The device slides rather than turns.
    #[arg(long)]
    linear: bool,
}

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum For {
    /// MuJoCo's XML.
    Mjcf,
    /// ROS's robot description.
    Urdf,
    /// USD with UsdPhysics, for Isaac Sim.
    Usd,
    /// A MATLAB function for a block of Simulink.
    SimulinkM,
    /// A Python module without dependencies.
    Python,
    /// Settings of this project's console that cancel friction and gravity.
    Console,
}

/// Exports.
///
/// # Errors
/// [`Failure`] for a model that cannot be used and a file that cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.own_effects.add()?;
    let path = &arguments.model;
    let apart = device_file::saved_model(path, None)?.apart();
    let (corrected, of_moments) = apart.map_err(|cause| Failure::ModelFile {
        path: path.clone(),
        cause,
    })?;
    if corrected.model.angle_rad != 1.0 {
        return Err(Failure::NotSi(path.clone()));
    }
    let name = path.file_stem().map_or_else(
        || "paddle".into(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let model = Model {
        name,
        device: corrected.device(),
        is_linear: arguments.linear,
    };
    let format = match arguments.format {
        For::Mjcf => Format::Mjcf,
        For::Urdf => Format::Urdf,
        For::Usd => Format::Usd,
        For::SimulinkM => Format::SimulinkM,
        For::Python => Format::Python,
        For::Console => Format::Console,
    };
    let Exported {
        text,
        approximated,
        left_out,
    } = exported(&model, format);
    let names: Vec<&str> = left_out.iter().map(|part| part.name()).collect();
    let mut said = String::new();
    for (part, how) in &approximated {
        said.push_str(&format!("approximated: {}: {how}\n", part.name()));
    }
    if !names.is_empty() {
        said.push_str(&format!(
            "not expressed in this format: {}\n",
            names.join(", ")
        ));
    }
    for moment in &of_moments {
        said.push_str(&format!("left out: {moment}\n"));
    }
    let json = json!({
        "format": 1,
        "text": text,
        "approximated": approximated.iter().map(|(part, how)| json!({ "name": part.name(), "how": how })).collect::<Vec<_>>(),
        "left_out": names,
        "of_moments": of_moments.iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    match &arguments.out {
        Some(out) => {
            files::leave(out, &text)?;
            said.push_str(&format!("model in {}\n", out.display()));
        }
        // The file has the same at its head.
        None => said = text,
    }
    Ok(Answer {
        text: said,
        json,
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
