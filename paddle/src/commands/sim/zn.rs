//! `paddle sim zn`: gains by the report's Ziegler-Nichols procedure.

use super::experiment::{metrics, table};
use super::rig::{Assembly, Rig};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::Folder;
use crate::numbers;
use crate::plot::{Figure, Ink, Line, Panel, step_response};
use crate::targets::{Target, Use};
use crate::tuning::trial;
use crate::tuning::ziegler_nichols::Ultimate;
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: paddle sim zn --plant refit --sensor hall

Raises the proportional gain alone by 5 % at a time until the swing after a step does not die down over 20 cycles: that
is Ku, its period Tu. Then Kp = 0.6 Ku, Ki = 2 Kp / Tu, Kd = Kp Tu / 8, and a step with these. The lines with `set` can
be typed into the console. A loop with much dry friction keeps swinging only after a large step.")]
pub struct Arguments {
    #[command(flatten)]
    rig: Rig,
    /// Amplitude of the steps, degrees.
    #[arg(long, default_value_t = 10.0, value_name = "deg", value_parser = numbers::positive)]
    amplitude: f64,
    /// Write a plot to this folder.
    #[arg(long, default_value = "paddle-out", value_name = "DIR")]
    out: PathBuf,
}

/// Duration of the step response with the final gains, s.
const STEP_S: f64 = 1.0;
/// Time axis of the oscillation in the plot, ms.
const SHOWN_MS: f64 = 1000.0;

/// Runs the procedure.
///
/// # Errors
/// Returns a [`Failure`] if the loop cannot be created, never sustains an oscillation, or exceeds its travel.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let Assembly {
        setup, warnings, ..
    } = arguments.rig.assemble()?;
    let amplitude_deg = arguments.amplitude;
    let ultimate = Ultimate::find(&setup, amplitude_deg)?;
    let gains = ultimate.pid();
    let step = trial::step(&setup, &gains, amplitude_deg, STEP_S)?;

    let title = format!("Ziegler-Nichols: {}", arguments.rig.title(&setup.settings));
    let points = ultimate.trial.points();
    let figure = Figure {
        title: title.clone(),
        x_label: "time, ms".into(),
        panels: vec![
            step_response(
                step.points(),
                amplitude_deg,
                f64::from(setup.settings.metrics.band_deg),
                &step.metrics,
            ),
            Panel {
                y_label: format!("position at Ku = {}, degrees", ultimate.gain),
                lines: vec![Line {
                    label: "position".into(),
                    ink: Ink::Measured,
                    points: points.into_iter().take_while(|p| p.0 <= SHOWN_MS).collect(),
                }],
                ..Panel::default()
            },
        ],
        ..Figure::default()
    };
    let mut folder = Folder::new(&arguments.out);
    folder.draw("zn.svg", figure.svg());

    let mut text = format!(
        "{warnings}{title}\n  Ku {} N m/°, Tu {:.1} ms, after {} gains\n\n{}\n",
        ultimate.gain,
        1e3 * ultimate.period_s,
        ultimate.tried,
        gains.lines()
    );
    text.push_str(&table(&step.metrics, &setup.settings));
    if let Some((time_s, fault)) = step.trace.fault {
        let _ = writeln!(text, "  stopped at {:.1} ms: {fault}", 1e3 * time_s);
    }
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    Ok(Answer {
        text,
        json: json!({
            "title": title,
            "ku_nm_per_deg": ultimate.gain,
            "tu_ms": 1e3 * ultimate.period_s,
            "gains": gains.json(),
            "console": gains.lines().lines().collect::<Vec<_>>(),
            "metrics": metrics(&step.metrics),
            "rig": arguments.rig.json(&setup),
            "files": folder.files(),
        }),
        problems: folder.lost(),
    })
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let plant = Target::of("--plant", Use::Read, self.rig.plant.file());
        let out = Target::of("--out", Use::NewFolder, &self.out);
        [plant, out].into_iter().flatten().collect()
    }
}
