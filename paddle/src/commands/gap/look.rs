//! `paddle gap look`: shows the torque that the nominal model lacks, and the quantity on which it depends.

use super::usable;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::{self, Folder};
use crate::provenance::Provenance;
use crate::report::missing_torque;
use crate::targets::{Target, Use};
use clap::Args;
use gap::missing_torque::Look;
use gap::{Device, MissingTorque};
use serde_json::json;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap look my-recording
  paddle gap look my-recording --report look.html --out look --json look.json

A smoother estimates the torque that the nominal model lacks over time, from input and position alone. It is drawn over the
axis that carries most of it, with what the best proposal of named effects gives drawn through and the rest beside. A
proposal is no diagnosis: `paddle gap diagnose` judges effects by simulation.")]
pub struct Arguments {
    /// Folder of the recording.
    recording: PathBuf,
    /// Write a page with the picture to this file.
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write the picture as SVG, and a CSV of time, torque and standard deviation per run, to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Estimates the missing torque.
///
/// # Errors
/// Returns a [`Failure`] if the recording cannot be used, and if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let recording = usable::read(&arguments.recording)?;
    let provenance = Provenance::of(&arguments.recording, &recording)?;
    let missing = MissingTorque::of(&recording, &Device::nominal(&recording.model));
    let look = missing.look(None);
    let sentence = missing_torque::sentence(&look);
    let mut text = format!("{sentence}\n");
    for share in &look.summary.shares {
        text.push_str(&format!("  {:<22}{:>6.2}\n", share.axis, share.share));
    }
    let additive = look.summary.additive_share;
    text.push_str(&format!(
        "  {:<22}{additive:>6.2}\n",
        "all of them together"
    ));
    for proposal in &look.proposals {
        let names = proposal.names().join(" + ");
        text.push_str(&format!("proposal {:>5.2}  {names}\n", proposal.share));
    }
    let picture = missing_torque::picture(&look, &recording.title, &recording.units.position)?;
    let mut problems = Vec::new();
    if let Some(path) = &arguments.report {
        let page = missing_torque::page(&recording.title, &sentence, &picture);
        match std::fs::write(path, page) {
            Ok(()) => text.push_str(&format!("report in {}\n", path.display())),
            Err(error) => problems.push(Failure::write(path)(error)),
        }
    }
    if let Some(folder) = &arguments.out {
        let mut folder = Folder::new(folder);
        folder.put("missing-torque.svg", &picture);
        for run in missing.runs() {
            let columns = [
                ("time", run.time_s.as_slice()),
                ("torque", &run.torque),
                ("std", &run.std),
            ];
            folder.put(&run.file, &files::csv(&columns));
        }
        if !folder.files().is_empty() {
            text.push_str(&format!("picture and CSV in {}\n", folder.path().display()));
        }
        problems.extend(folder.lost());
    }
    Ok(Answer {
        text,
        json: json(&look, &provenance),
        problems,
    })
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let report = Target::of("--report", Use::File, self.report.as_ref());
        let out = Target::of("--out", Use::NewFolder, self.out.as_ref());
        [report, out].into_iter().flatten().collect()
    }
}

/// The result as JSON.
fn json(look: &Look, provenance: &Provenance) -> serde_json::Value {
    let proposals = look.proposals.iter().map(|proposal| {
        let effects = proposal.effects.iter();
        let effects: Vec<_> = effects
            .map(|(name, values)| json!({ "name": name, "values": values }))
            .collect();
        json!({ "effects": effects, "share": proposal.share })
    });
    let proposals: Vec<_> = proposals.collect();
    let orders = look.orders.iter().map(|order| {
        json!({
            "wave_number": order.wave_number, "amplitude": order.amplitude, "phase": order.phase
        })
    });
    let orders: Vec<_> = orders.collect();
    json!({
        "format": 1,
        "missing_torque": look.summary,
        "axis": look.axis,
        "proposals": proposals,
        "ripple": orders,
        "provenance": provenance,
    })
}
