//! `paddle reproduce`: compares the numbers of the lab report with the simulation, row by row.

mod apparatus;
mod gains;
mod row;
mod simulated_step;
mod sinusoid;
mod ultimate;

use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::Folder;
use crate::targets::{Target, Use};
use apparatus::Apparatus;
use clap::Args;
use gains::Gains;
use host_sim::effects::{Effect, check_distinct};
use recording::Recording;
use serde_json::json;
use simulated_step::SimulatedSteps;
use sinusoid::Sinusoids;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of the command.
#[derive(Args)]
#[command(after_help = "Example: paddle reproduce --check --json report.json

Every number of the lab report against ours. The closed-loop rows are all run on one plant: the paddle as refitted to the
encoder logs, on the lab's board, whose 350 µs take 351, through the control core. Each step starts where its log does.
Times are the board's, metrics those of the filtered position. Torque sines run on the lab's own Simulink model.")]
pub struct Arguments {
    /// End with status 1 if a row is outside its bar.
    #[arg(long)]
    check: bool,
    /// Add this effect to the plant, to see how the rows change; may be repeated.
    #[arg(long, value_name = "EFFECT:PARAMETER=VALUE,...")]
    with: Vec<Effect>,
    /// Folder of the lab's recordings `sine-0011` and `steps-encoder`, which are plotted beside the simulation [default:
    /// ../shared/data/epfl-paddle, if it exists].
    #[arg(long, value_name = "DIR")]
    recorded: Option<PathBuf>,
    /// Write the figures to this folder.
    #[arg(long, default_value = "paddle-out/reproduce", value_name = "DIR")]
    out: PathBuf,
}

/// Reproduces the report.
///
/// # Errors
/// Returns a [`Failure`] if a recording cannot be used, or if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    check_distinct(&arguments.with)?;
    let folder = arguments.recorded.as_deref();
    let recorded = |name: &str| {
        let folder = folder.unwrap_or(Path::new(RECORDED)).join(name);
        folder
            .exists()
            .then(|| Recording::read(&folder))
            .transpose()
    };
    let (sine, steps) = (recorded("sine-0011")?, recorded("steps-encoder")?);
    if let (Some(folder), None, None) = (folder, &sine, &steps) {
        return Err(Failure::NotRecorded(folder.to_owned()));
    }
    let apparatus = Apparatus {
        with: arguments.with.clone(),
    };
    let gains = Gains::run(&apparatus)?;
    let sinusoids = Sinusoids::run(sine.as_ref())?;
    let simulated = SimulatedSteps::run();
    let mut rows = gains.rows();
    rows.extend(ultimate::rows(&apparatus)?);
    rows.extend(sinusoids.rows());
    rows.extend(simulated.rows());

    let mut folder = Folder::new(&arguments.out);
    let figure_6 = [("figure-6.svg", simulated.figure())];
    let figures = sinusoids.figures().into_iter().chain(figure_6);
    for (name, figure) in figures.chain(gains.figures(steps.as_ref())) {
        folder.draw(name, figure.svg());
    }

    let verdicts: Vec<_> = rows.iter().filter_map(row::Row::ok).collect();
    let missed = verdicts.iter().filter(|ok| !**ok).count();
    let barred = verdicts.len();
    let mut text = row::table(&rows);
    let _ = writeln!(
        text,
        "{} of {barred} rows with a bar clear it",
        barred - missed
    );
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    Ok(Answer {
        text,
        json: json!({
            "rows": rows.iter().map(row::Row::json).collect::<Vec<_>>(),
            "files": folder.files(),
        }),
        problems: (arguments.check && missed > 0)
            .then_some(Failure::Missed { missed, barred })
            .into_iter()
            .chain(folder.lost())
            .collect(),
    })
}

/// Default folder of the lab's recordings.
const RECORDED: &str = "../shared/data/epfl-paddle";

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("--out", Use::NewFolder, &self.out)
            .into_iter()
            .collect()
    }
}
