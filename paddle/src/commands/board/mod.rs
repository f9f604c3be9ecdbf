//! `paddle board`: the flashed image on a virtual board, wired to the simulated paddle.

mod firmware;
mod leave;
mod live;

use crate::answer::Answer;
use crate::commands::sim::SensorChoice;
use crate::failure::Failure;
use crate::files::Folder;
use crate::plant_choice::{Plant, PlantChoice};
use clap::Args;
use clap::builder::PossibleValuesParser;
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::closed_loop::LoopSetup;
use host_sim::effects::Effect;
use host_sim::presets;
use recording::Model;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use virtual_board::board::Board;
use virtual_board::image::Image;
use virtual_board::log::Entry;
use virtual_board::script::Script;
use virtual_board::wiring::Wires;

/// Which board, and what to do with it.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle board                                a terminal device, at the pace of the clock on the wall
  paddle board --script session.txt --out my-session --recording my-recording

A script has a line for everything that is typed, after the time in seconds since power-on:
  0.1  zero hall
  0.2  arm
  0.6  step 10
and, after an exclamation mark, for what else happens to the board: !bridge-fault on, !bridge-fault off,
!supply-off SECONDS, !reset, !crystal-stop, !wire NAME.")]
pub struct Arguments {
    /// The image, ready to be flashed [default: the firmware of this repository, built if need be].
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Type what this file says, as fast as the computer can.
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Run for so long, as fast as the computer can [default with --script: half a second beyond its last line].
    #[arg(long, value_name = "s")]
    seconds: Option<f64>,
    /// `nominal`, `refit`, or a TOML file with what differs from nominal: [model] and with = ["effect"].
    #[arg(long, default_value = "refit", value_name = "nominal|refit|FILE.toml")]
    plant: PlantChoice,
    /// Switch an effect into the paddle; may be repeated. `paddle effects` lists them.
    #[arg(long, value_name = "EFFECT:PARAMETER=VALUE,...")]
    with: Vec<Effect>,
    /// Sensor that effects of sensing act on.
    #[arg(long, value_enum, default_value = "encoder")]
    sensor: SensorChoice,
    /// Wire the paddle wrongly; may be repeated.
    #[arg(long, value_name = "FAULT", value_parser = PossibleValuesParser::new(Wires::NAMED.map(|(name, _)| name)))]
    wire: Vec<String>,
    /// Where the paddle stands at power-on, degrees.
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_name = "deg"
    )]
    start: f64,
    /// Of all noise.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Leave what the firmware saw, and what it said, in this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Leave a recording of what the paddle really did in this folder, for `paddle gap`.
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
    /// Rows a second of both.
    #[arg(long, default_value_t = 1000.0, value_name = "Hz")]
    log_rate: f64,
    /// Prediction window that the recording states.
    #[arg(long, default_value_t = 0.5, value_name = "s")]
    horizon: f64,
}

/// Beyond the last line of a script, s.
const AFTER_SCRIPT_S: f64 = 0.5;
/// Longest run as fast as the computer can, s.
const LONGEST_S: f64 = 3600.0;

/// Runs the board.
///
/// # Errors
/// [`Failure`] for an image, a script or options that cannot be used, files that cannot be written, and a board that
/// can go no further.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let (setup, model) = arguments.assemble()?;
    let script = arguments.read_script()?;
    let steps_per_row = leave::steps_per_row(arguments.log_rate)?;
    let path = match &arguments.elf {
        Some(path) => path.clone(),
        None => firmware::build()?,
    };
    let image = Image::read(&path)?;
    let mut wires = Wires::default();
    for name in &arguments.wire {
        wires.change(name);
    }
    let mut board = Board::new(&image, &setup.paddle, &setup.settings, wires)?;
    let header = format!("image {}\n  SHA-256 {}\n", path.display(), image.hash());

    let seconds = match (arguments.seconds, &script) {
        (Some(seconds), _) => seconds,
        (None, Some(script)) => script.end_s() + AFTER_SCRIPT_S,
        (None, None) => return live::run(&mut board, &header),
    };
    if !(seconds > 0.0 && seconds <= LONGEST_S) {
        return Err(Failure::Board(format!(
            "--seconds {seconds}: give more than 0 and at most {LONGEST_S}"
        )));
    }
    board.record_steps(arguments.out.is_some() || arguments.recording.is_some());
    let began = Instant::now();
    script.unwrap_or_default().run(&mut board, seconds)?;
    let took_s = began.elapsed().as_secs_f64();

    let console = String::from_utf8_lossy(&board.terminal.take_answer()).replace("\r\n", "\n");
    let log = board.take_log();
    let instructions = board.cpu.instructions();
    let mut text = format!("{header}\n{console}\n\n");
    for entry in &log {
        let _ = writeln!(text, "{}", line(entry));
    }
    let (real_time, rate) = (seconds / took_s, instructions as f64 / took_s);
    let _ = writeln!(
        text,
        "{seconds} s in {took_s:.2} s: {real_time:.1} times real time, {:.0} million instructions a second",
        1e-6 * rate
    );
    let resets: Vec<_> = board
        .resets()
        .iter()
        .map(|(time_s, cause)| json!({ "time_s": time_s, "cause": format!("{cause:?}") }))
        .collect();
    for (time_s, cause) in board.resets() {
        let _ = writeln!(text, "reset at {time_s:.4} s: {cause:?}");
    }
    let mut result = json!({
        "image": path, "sha256": image.hash(), "seconds": seconds, "console": console,
        "log": log.iter().map(line).collect::<Vec<_>>(), "resets": resets,
        "instructions": instructions, "times_real_time": real_time, "instructions_per_s": rate,
    });

    let steps = board.take_steps();
    if let Some(path) = &arguments.out {
        let mut folder = Folder::make(path)?;
        folder.put("console.txt", &console)?;
        folder.put("trace.csv", &leave::trace(&steps, steps_per_row))?;
        for file in folder.files() {
            let _ = writeln!(text, "{}", file.display());
        }
        result["files"] = json!(folder.files());
    }
    if let Some(path) = &arguments.recording {
        leave::recording(
            path,
            &steps,
            steps_per_row,
            arguments.horizon,
            model,
            &setup,
        )?;
        let _ = writeln!(text, "recording in {}", path.display());
        result["recording"] = json!(path);
    }
    Ok(Answer {
        text,
        json: result,
        ..Answer::default()
    })
}

impl Arguments {
    /// What the board is wired to, and the model that a recording of it states as nominal.
    fn assemble(&self) -> Result<(LoopSetup, Model), Failure> {
        let Plant {
            mut device, model, ..
        } = self.plant.load()?;
        for effect in &self.with {
            effect.install(&mut device);
        }
        // The firmware boots with its defaults, whatever a file says; the sensors are those that they expect.
        let mut settings = Settings::default();
        settings.estimate.sensor = match self.sensor {
            SensorChoice::Encoder => Sensor::Encoder,
            SensorChoice::Hall => Sensor::Hall,
        };
        if self.start.is_nan() || self.start.abs() > 90.0 {
            return Err(Failure::Board(format!(
                "--start {}: give -90 to 90 degrees",
                self.start
            )));
        }
        let mut setup = LoopSetup::firmware(device, settings, presets::motor());
        setup.paddle.seed = self.seed;
        setup.paddle.start_rad = self.start.to_radians();
        Ok((setup, model))
    }

    fn read_script(&self) -> Result<Option<Script>, Failure> {
        let Some(path) = &self.script else {
            return Ok(None);
        };
        let text = std::fs::read_to_string(path).map_err(Failure::read(path))?;
        let script = Script::parse(&text)
            .map_err(|error| Failure::Board(format!("{}: {error}", path.display())))?;
        Ok(Some(script))
    }
}

/// A line of the log for people.
fn line(entry: &Entry) -> String {
    format!(
        "log {:.4} s {} {}",
        entry.time_s, entry.level, entry.message
    )
}
