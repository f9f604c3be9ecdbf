//! `paddle gap measure`: measures the gap of one model on one recording.

use super::own_effects::OwnEffects;
use super::usable;
use crate::answer::Answer;
use crate::device_file::{self, DeviceFile};
use crate::failure::Failure;
use crate::files::{self, Folder};
use crate::plot::{Figure, Ink, Line, Panel};
use crate::provenance::Provenance;
use crate::targets::{Target, Use};
use clap::Args;
use gap::model_file::LeftOut;
use gap::{Gap, PredictedRun};
use host_sim::device::Device;
use recording::Recording;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap measure my-recording
  paddle gap measure my-recording --model corrected.toml --predictions out --json gap.json

The model predicts the position from the input, re-started from the measured state every horizon. The gap is the rms of
measured minus predicted; the floor is what sensor noise, quantising and the restarts alone would leave.")]
pub struct Arguments {
    /// Folder of the recording.
    recording: PathBuf,
    /// Use this model instead of the recording's own: a file that `paddle gap diagnose --save-model` wrote, or a device file
    /// with the changes from the recording's model.
    #[arg(long, value_name = "FILE.toml")]
    model: Option<PathBuf>,
    #[command(flatten)]
    own_effects: OwnEffects,
    /// Write a CSV of time, measured and predicted position per run, with a plot, to this folder.
    #[arg(long, value_name = "DIR")]
    predictions: Option<PathBuf>,
}

const FLOOR_OF_GIVEN: &str =
    "the floor is what noise, quantising and restarts alone would leave if this model were right\n";
const FLOOR_OF_NOMINAL: &str = "the floor is what noise, quantising and restarts alone would leave if the nominal model were \
     right; `paddle gap diagnose` gives that of the corrected model, and this one beside it\n";

/// Measures the gap.
///
/// # Errors
/// Returns a [`Failure`] if the recording or the model cannot be used.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    arguments.own_effects.add()?;
    let recording = usable::read(&arguments.recording)?;
    let mut provenance = Provenance::of(&arguments.recording, &recording)?;
    let mut warnings = recording.warnings();
    let floor_of = match &arguments.model {
        Some(path) => {
            provenance = provenance.and(path)?;
            "model_given"
        }
        None => "nominal_model",
    };
    let device = match &arguments.model {
        Some(path) => {
            let (device, left_out) = device(path, &recording)?;
            warnings.extend(left_out.iter().map(ToString::to_string));
            device
        }
        None => Device::nominal(&recording.model),
    };
    let (gap, runs) = gap::measure(&recording, &device);
    let mut text: String = warnings
        .iter()
        .map(|warning| format!("warning: {warning}\n"))
        .collect();
    text.push_str(&sentence(&gap));
    text.push_str(match arguments.model {
        Some(_) => FLOOR_OF_GIVEN,
        None => FLOOR_OF_NOMINAL,
    });
    let mut problems = Vec::new();
    if let Some(folder) = &arguments.predictions {
        let mut folder = Folder::new(folder);
        for run in &runs {
            leave(&mut folder, run, &gap);
        }
        if !folder.files().is_empty() {
            text.push_str(&format!("predictions in {}\n", folder.path().display()));
        }
        problems = folder.lost();
    }
    Ok(Answer {
        text,
        json: json!({
            "format": 1,
            "gap": {
                "before": gap.before,
                "floor": gap.floor,
                "floor_of": floor_of,
                "unit": gap.unit,
            },
            "warnings": warnings,
            "provenance": provenance,
        }),
        problems,
    })
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let model = Target::of("--model", Use::Read, self.model.as_ref());
        let predictions = Target::of("--predictions", Use::NewFolder, self.predictions.as_ref());
        [model, predictions].into_iter().flatten().collect()
    }
}

/// Reads the device of a file. Also lists the parts of it that apply only at one time of another recording. A file with
/// `format` was written by `paddle gap diagnose --save-model` and is complete. Any other file states the changes from the
/// recording's model.
fn device(path: &Path, recording: &Recording) -> Result<(Device, Vec<LeftOut>), Failure> {
    if !device_file::stands_alone(path)? {
        let file = DeviceFile::read(path)?;
        if file.has_settings_alone() {
            return Err(Failure::DeviceFile {
                path: path.to_owned(),
                cause: "[settings] are the control core's, which a prediction does not run; give [model] or with = [\"effect\"]".into(),
            });
        }
        let device = file.device(&recording.model)?;
        return Ok((device, Vec::new()));
    }
    let on_recording = device_file::saved_model(path, Some(&recording.model))?.on(recording);
    let (corrected, left_out) = on_recording.map_err(|cause| Failure::ModelFile {
        path: path.to_owned(),
        cause,
    })?;
    Ok((corrected.device(), left_out))
}

/// The gap as one line of text.
pub fn sentence(gap: &Gap) -> String {
    let shown = |value: f64| match gap.unit.as_str() {
        "rad" => format!("{:.4}°", value.to_degrees()),
        unit => format!("{value:.4e} {unit}"),
    };
    let times = match gap.floor > 0.0 {
        true => format!(", {:.1} times the floor", gap.before / gap.floor),
        false => String::new(),
    };
    format!(
        "gap {} rms, floor {}{times}\n",
        shown(gap.before),
        shown(gap.floor)
    )
}

/// Writes the CSV and the plot of a run to `folder`.
pub fn leave(folder: &mut Folder, run: &PredictedRun, gap: &Gap) {
    let columns = [
        ("time", run.time.as_slice()),
        ("measured", &run.measured),
        ("predicted", &run.predicted),
    ];
    folder.put(&run.file, &files::csv(&columns));
    let plot = PathBuf::from(&run.file).with_extension("svg");
    folder.draw(plot, figure(run, gap).svg());
}

/// Plots the measured and the predicted position above their difference.
fn figure(run: &PredictedRun, gap: &Gap) -> Figure {
    let (unit, scale) = match gap.unit.as_str() {
        "rad" => ("degrees", 1f64.to_degrees()),
        unit => (unit, 1.0),
    };
    let scaled = |values: &[f64]| values.iter().map(|v| v * scale).collect::<Vec<_>>();
    let between: Vec<_> = run
        .measured
        .iter()
        .zip(&run.predicted)
        .map(|(m, p)| (m - p) * scale)
        .collect();
    let line = |label, ink, y: &[f64]| Line::new(label, ink, &run.time, y);
    Figure {
        title: format!("{}: {}", run.file, sentence(gap).trim_end()),
        x_label: "time, s".into(),
        panels: vec![
            Panel {
                y_label: format!("position, {unit}"),
                lines: vec![
                    line("measured", Ink::Measured, &scaled(&run.measured)),
                    line("model", Ink::Model, &scaled(&run.predicted)),
                ],
                ..Panel::default()
            },
            Panel {
                y_label: format!("measured minus model, {unit}"),
                lines: vec![line("difference", Ink::Other(0), &between)],
                ..Panel::default()
            },
        ],
        ..Figure::default()
    }
}
