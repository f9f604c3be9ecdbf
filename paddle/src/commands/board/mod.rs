//! `paddle board`: runs the firmware image on a virtual board that is connected to the simulated paddle.

pub mod firmware;
mod leave;
mod live;

use crate::answer::Answer;
use crate::commands::sim::SensorChoice;
use crate::device_file::CHECK_THE_NAME;
use crate::failure::Failure;
use crate::files::Folder;
use crate::interrupt::Interrupt;
use crate::numbers;
use crate::plant_choice::{Plant, PlantChoice};
use crate::targets::{Target, Use};
use clap::Args;
use clap::builder::PossibleValuesParser;
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::closed_loop::LoopSetup;
use host_sim::effects::Effect;
use host_sim::presets;
use leave::{Session, log_line};
use recording::{Model, open_file, read_text};
use serde_json::json;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;
use virtual_board::board::Board;
use virtual_board::image::Image;
use virtual_board::script::Script;
use virtual_board::wiring::Wires;

/// Options that select the board, its inputs and its outputs.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle board                                # a terminal device, at the pace of the clock on the wall
  paddle board --script session.txt --out my-session --recording my-recording

A script has a line for everything that is typed, after the time in seconds since power-on:
  1.0  zero hall
  1.1  arm
  1.6  step 10
and, after an exclamation mark, for what else happens to the board: !bridge-fault on, !bridge-fault off,
!supply-off SECONDS, !reset, !crystal-stop, !wire NAME.

At the pace of the clock on the wall it runs until Ctrl-C, or a signal that asks it to end, and then leaves what --out and
--recording ask for. Up to then these take 0.4 GB of memory an hour, at 1000 rows a second.")]
pub struct Arguments {
    /// Firmware image [default: the firmware of this repository, which is built if necessary].
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Run without real-time pacing and type the lines of this script at the terminal.
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Run for this simulated time without real-time pacing [default with --script: half a second beyond its last line].
    #[arg(long, value_name = "s", value_parser = numbers::positive)]
    seconds: Option<f64>,
    /// Paddle model: `nominal`, `refit`, or a TOML file with the changes from nominal: [model] and with = ["effect"].
    #[arg(long, default_value = "refit", value_name = "nominal|refit|FILE.toml")]
    plant: PlantChoice,
    /// Add this effect to the paddle; may be repeated. `paddle effects` lists the effects.
    #[arg(long, value_name = "EFFECT:PARAMETER=VALUE,...")]
    with: Vec<Effect>,
    /// Sensor on which sensing effects act.
    #[arg(long, value_enum, default_value = "encoder")]
    sensor: SensorChoice,
    /// Add a wiring fault; may be repeated.
    #[arg(long, value_name = "FAULT", value_parser = PossibleValuesParser::new(Wires::NAMED.map(|(name, _)| name)))]
    wire: Vec<String>,
    /// Paddle angle at power-on, degrees.
    #[arg(
        long,
        default_value_t = 0.0,
        value_parser = numbers::finite,
        allow_negative_numbers = true,
        value_name = "deg"
    )]
    start: f64,
    /// Simulated time per wall-clock time. The computer's speed limits it.
    #[arg(long, default_value_t = 1.0, value_name = "TIMES", value_parser = numbers::positive)]
    pace: f64,
    /// Seed of the random noise.
    #[arg(long, default_value_t = 0, value_parser = numbers::whole)]
    seed: u64,
    /// Write the firmware's measurements and its terminal output to this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write a recording of the true motion to this folder, for `paddle gap`.
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
    /// Rows per second of the trace and of the recording.
    #[arg(long, default_value_t = 1000.0, value_name = "Hz", value_parser = numbers::positive)]
    log_rate: f64,
    /// Prediction window that the recording states.
    #[arg(long, default_value_t = 0.5, value_name = "s", value_parser = numbers::positive)]
    horizon: f64,
}

/// Simulated time after the last line of a script, s.
const AFTER_SCRIPT_S: f64 = 0.5;
/// Longest simulated run without real-time pacing, s.
const LONGEST_S: f64 = 3600.0;

/// Runs the board.
///
/// Returns a [`Failure`] if the image, the script or the options cannot be used, if a file cannot be written, or if the
/// virtual board cannot continue.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let (setup, model, warnings) = arguments.assemble()?;
    let script = arguments.read_script()?;
    let mut session = Session::new(arguments.log_rate)?;
    let seconds = arguments.duration_s(script.as_ref())?;
    let path = match &arguments.elf {
        Some(path) => path.clone(),
        None => firmware::build()?,
    };
    let unusable = |source| Failure::Image {
        path: path.clone(),
        source,
    };
    let image = Image::parse(bytes(&path)?).map_err(unusable)?;
    let mut wires = Wires::default();
    for name in &arguments.wire {
        wires.change(name);
    }
    let mut board = Board::new(&image, &setup.paddle, &setup.settings, wires).map_err(unusable)?;
    let header = format!(
        "{warnings}image {}\n  SHA-256 {}\n",
        path.display(),
        image.hash()
    );
    board.record_steps(arguments.out.is_some() || arguments.recording.is_some());
    let interrupt = Interrupt::watched()?;
    let began = Instant::now();
    let ended = match seconds {
        Some(seconds) => {
            let mut go_on = |board: &mut Board| {
                session.take(board);
                !interrupt.is_requested()
            };
            script
                .unwrap_or_default()
                .run(&mut board, seconds, &mut go_on)
                .map_err(Failure::from)
        }
        None => live::run(
            &mut board,
            &header,
            &mut session,
            &interrupt,
            arguments.pace,
        ),
    };
    let took_s = began.elapsed().as_secs_f64();
    session.take(&mut board);
    // The data up to the time at which the board stopped is valid.
    let mut problems: Vec<Failure> = ended.err().into_iter().collect();
    let ran_s = board.time_s();
    if let Some(seconds) = seconds.filter(|_| interrupt.is_requested()) {
        problems.push(Failure::Board(format!(
            "the user stopped the run at {ran_s:.3} s of {seconds} s; the data up to this time is kept"
        )));
    }

    let console = session.console();
    let instructions = board.cpu.instructions();
    let (real_time, rate) = (ran_s / took_s, instructions as f64 / took_s);
    let mut text = String::new();
    if seconds.is_some() {
        text = format!("{header}\n{console}\n\n");
        for entry in &session.log {
            let _ = writeln!(text, "{}", log_line(entry));
        }
    }
    let _ = writeln!(
        text,
        "{ran_s:.3} s in {took_s:.2} s: {real_time:.1} times real time, {:.0} million instructions a second",
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
        "image": path, "sha256": image.hash(), "seconds": ran_s, "console": console,
        "log": session.log.iter().map(log_line).collect::<Vec<_>>(), "resets": resets,
        "instructions": instructions, "times_real_time": real_time, "instructions_per_s": rate,
    });
    if let Some(path) = &arguments.out {
        let mut folder = Folder::new(path);
        folder.put("console.txt", &console);
        folder.put("trace.csv", &session.trace());
        for file in folder.files() {
            let _ = writeln!(text, "{}", file.display());
        }
        result["files"] = json!(folder.files());
        problems.extend(folder.lost());
    }
    if let Some(path) = &arguments.recording {
        let recording = session.recording(arguments.horizon, model, &setup);
        match recording.write(path) {
            Ok(()) => {
                let _ = writeln!(text, "recording in {}", path.display());
                result["recording"] = json!(path);
                // An invalid recording is written all the same, because it shows the true motion.
                if let Err(refusal) = recording.validate() {
                    let _ = writeln!(text, "warning: `paddle gap` would refuse it: {refusal}");
                }
            }
            Err(failure) => problems.push(failure.into()),
        }
    }
    Ok(Answer {
        text,
        json: result,
        problems,
    })
}

/// Reads the bytes of a file.
fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    open_file(path, "build the image with `cargo fw`")?
        .read_to_end(&mut bytes)
        .map_err(Failure::read(path))?;
    Ok(bytes)
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let elf = Target::of("--elf", Use::Read, self.elf.as_ref());
        let script = Target::of("--script", Use::Read, self.script.as_ref());
        let plant = Target::of("--plant", Use::Read, self.plant.file());
        let out = Target::of("--out", Use::NewFolder, self.out.as_ref());
        let recording = Target::of("--recording", Use::NewFolder, self.recording.as_ref());
        let all = [elf, script, plant, out, recording];
        all.into_iter().flatten().collect()
    }

    /// Duration of a run without real-time pacing, s. `None` for a run in real time.
    fn duration_s(&self, script: Option<&Script>) -> Result<Option<f64>, Failure> {
        let end_s = script.map(Script::end_s);
        let Some(seconds) = self.seconds.or(end_s.map(|end_s| end_s + AFTER_SCRIPT_S)) else {
            return Ok(None);
        };
        if seconds > LONGEST_S {
            return Err(Failure::Board(format!(
                "--seconds {seconds}: give at most {LONGEST_S}"
            )));
        }
        if let Some(end_s) = end_s.filter(|end_s| *end_s > seconds) {
            return Err(Failure::Board(format!(
                "--seconds {seconds}: the script goes on to {end_s} s; run for longer, or take lines out"
            )));
        }
        if self.recording.is_some() && seconds < self.horizon {
            return Err(Failure::Board(format!(
                "--horizon {}: the recording lasts {seconds} s, less than one prediction window; run for longer with --seconds, or give a shorter one",
                self.horizon
            )));
        }
        Ok(Some(seconds))
    }

    /// The loop to which the board is connected, and the model that its recording states as nominal.
    fn assemble(&self) -> Result<(LoopSetup, Model, String), Failure> {
        let mut plant = self.plant.load()?;
        plant.install(&self.with)?;
        let Plant {
            device,
            model,
            mut warnings,
            has_settings,
            ..
        } = plant;
        if has_settings {
            warnings.push_str(&format!(
                "warning: [settings] of {} are left out, as the firmware boots with its own; type them with `set`\n",
                self.plant
            ));
        }
        // The firmware boots with its default settings, so settings in a file have no effect. The sensors match these
        // defaults.
        let mut settings = Settings::default();
        settings.estimate.sensor = match self.sensor {
            SensorChoice::Encoder => Sensor::Encoder,
            SensorChoice::Hall => Sensor::Hall,
        };
        if self.start.abs() > 90.0 {
            return Err(Failure::Board(format!(
                "--start {}: give -90 to 90 degrees",
                self.start
            )));
        }
        let mut setup = LoopSetup::firmware(device, settings, presets::motor());
        setup.paddle.seed = self.seed;
        setup.paddle.start_rad = self.start.to_radians();
        Ok((setup, model, warnings))
    }

    fn read_script(&self) -> Result<Option<Script>, Failure> {
        let Some(path) = &self.script else {
            return Ok(None);
        };
        let text = read_text(path, CHECK_THE_NAME)?;
        let script = Script::parse(&text)
            .map_err(|error| Failure::Board(format!("{}: {error}", path.display())))?;
        Ok(Some(script))
    }
}
