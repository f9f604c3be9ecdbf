//! `paddle gap import`: converts logs of other programs to a recording.

use super::known::KnownArguments;
use crate::answer::Answer;
use crate::failure::Failure;
use crate::targets::{Target, Use};
use clap::Args;
use import::{ImportError, Imported, PidLaw, Recipe, SwitchOn};
use serde_json::json;
use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};

/// Options that select the logs and their columns.
#[derive(Args)]
#[command(after_help = "Examples:
  paddle gap import run.csv --out my-recording
  paddle gap import log.csv.gz --time 'timestamp [s]' --input 'tau_cmd:Nm' --position 'q[2]:deg' --out my-recording
  paddle gap import log.csv --input 'present_pwm:duty' --position 'enc:counts' --counts-per-turn 4096 --out my-recording
  paddle gap import log.csv --input '0.01*(sp-pos)/15' --position pos:deg --out my-recording

A column is NAME or NAME:UNIT; a formula may stand wherever a column may, and takes odd names in braces: '2*{q[2]}'. What
is left out is told from names, units and numbers, and shown. The recording is in rad, m, s, N m; the format is described
in docs/recording-format.md.")]
pub struct Arguments {
    /// Log files: delimited text, plain or compressed. The formats .npz, .mat, Parquet and MCAP need a build with them.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Folder for the recording.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Accept the guessed columns without a question.
    #[arg(long)]
    yes: bool,
    #[command(flatten)]
    columns: Columns,
    #[command(flatten)]
    known: KnownArguments,
}

/// Meaning of the columns.
#[derive(Args)]
struct Columns {
    /// Time: a column in s, ms, us, ns or as date and time, or a formula in s.
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Rows per second of a log without a time column.
    #[arg(long, value_name = "HZ", conflicts_with = "time")]
    rate: Option<f64>,
    /// Input: the command of the actuator.
    #[arg(long, value_name = "COLUMN")]
    input: Option<String>,
    /// Measured position.
    #[arg(long, value_name = "COLUMN", conflicts_with = "velocity")]
    position: Option<String>,
    /// Measured velocity, if no position was logged. The position is its integral.
    #[arg(long, value_name = "COLUMN")]
    velocity: Option<String>,
    /// Setpoint of the position.
    #[arg(long, value_name = "COLUMN")]
    setpoint: Option<String>,
    /// Further column of the recording: position_NAME, current, supply or temperature; may be repeated.
    #[arg(long, value_name = "NAME=COLUMN", value_parser = super::known::pair)]
    column: Vec<(String, String)>,
    /// Encoder counts per turn of the position.
    #[arg(long, value_name = "COUNTS")]
    counts_per_turn: Option<f64>,
    /// Resolution of the position in its logged unit [default: estimated from the readings].
    #[arg(long, value_name = "STEP")]
    resolution: Option<f64>,
    /// Standard deviation of the position noise in its logged unit [default: estimated from the readings].
    #[arg(long, value_name = "STD")]
    noise: Option<f64>,
    /// Span at which the position wraps around, in its logged unit; 0 if it does not wrap.
    #[arg(long, value_name = "SPAN")]
    wrap: Option<f64>,
    /// Number of the sign bit in the position words, counted from 0.
    #[arg(long, value_name = "BIT")]
    position_sign_bit: Option<u32>,
    /// Number of the sign bit in the input words, counted from 0; 10 for loads from 0 to 2047.
    #[arg(long, value_name = "BIT")]
    input_sign_bit: Option<u32>,
    /// Width of the input words in bits; the words are two's complement.
    #[arg(long, value_name = "BITS")]
    input_bits: Option<u32>,
    /// The input of a row is the value at that time, not a value that is held until the next row.
    #[arg(long)]
    input_of_instant: bool,
    /// Period of the device's control loop, s. Formulas are averaged over the loop periods until the next row.
    #[arg(long, value_name = "S")]
    tick: Option<f64>,
    /// Corner frequency of a first-order low-pass that the device applied to the logged position. The import inverts the
    /// low-pass.
    #[arg(long, value_name = "HZ", requires = "tick")]
    undo_low_pass: Option<f64>,
    /// Compute the input, which was not logged, as the output of a PID on the logged position: 'kp=0.05/15,ki=0,kd=Kd/15'.
    /// The gains are numbers or formulas of columns, per unit of the logged position.
    #[arg(long, value_name = "GAINS", requires = "tick")]
    pid: Option<String>,
    /// Limit of the PID's output: it is clipped to ± this value.
    #[arg(long, value_name = "LIMIT", requires = "pid")]
    limit: Option<f64>,
    /// Time at which the PID was switched on, one per log: s on the log's clock, or `found`. With `found` the import takes
    /// the time that fits the motion best, which is uncertain by one or two loop periods.
    #[arg(long, value_name = "S|found", requires = "pid", value_delimiter = ',')]
    on: Vec<String>,
    /// Part of each run to keep, in s from the start of the run, or from the time at which the PID was switched on.
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true, value_parser = span)]
    keep: Option<[f64; 2]>,
    /// Start a new run after a time gap longer than this.
    #[arg(long, value_name = "S")]
    split_gap: Option<f64>,
    /// Start a new run where the value of this column changes.
    #[arg(long, value_name = "COLUMN")]
    split_by: Option<String>,
    /// The input is the output of a feedback controller.
    #[arg(long)]
    closed_loop: bool,
    /// Length of a prediction window, s.
    #[arg(long, value_name = "S")]
    horizon: Option<f64>,
    /// Title of the recording.
    #[arg(long)]
    title: Option<String>,
}

/// Imports the logs.
///
/// # Errors
/// Returns a [`Failure`] if a log cannot be parsed, or if the recording cannot be used or written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let recipe = arguments.columns.recipe()?;
    let logs = arguments.logs.iter().map(|path| import::read_log(path));
    let logs = logs.collect::<Result<Vec<_>, ImportError>>()?;
    let imported = import::import(&logs, &recipe)?;
    let known = arguments.known.known()?;
    let shown = shown(&imported);
    if imported.is_guessed && !arguments.yes && !is_confirmed(&shown) {
        return Err(Failure::NotConfirmed);
    }
    let text = import::manifest(
        &imported.recording,
        &known,
        &imported.roles,
        imported.is_integrated,
    )?;
    imported.recording.write(&arguments.out)?;
    let mut warnings = leave_manifest(&arguments.out, &text)?;
    warnings.extend(known.unstated_warning());
    Ok(answer(shown, &imported, warnings, &arguments.out))
}

/// Writes the manifest beside the runs and reads the complete recording back. Returns the warnings about it.
///
/// # Errors
/// Returns a [`Failure`] if the recording cannot be written or used.
pub fn leave_manifest(folder: &Path, text: &str) -> Result<Vec<String>, Failure> {
    let path = folder.join("recording.toml");
    std::fs::write(&path, text).map_err(Failure::write(&path))?;
    Ok(recording::Recording::read(folder)?.warnings())
}

/// The answer of an import, with its warnings.
pub fn answer(mut shown: String, imported: &Imported, warnings: Vec<String>, out: &Path) -> Answer {
    for warning in &warnings {
        // Writing to a String cannot fail.
        let _ = writeln!(shown, "warning: {warning}");
    }
    let _ = writeln!(
        shown,
        "recording in {out}: look through {out}/recording.toml, then paddle gap diagnose {out}",
        out = out.display()
    );
    let runs =
        imported.recording.runs.iter().map(
            |run| json!({ "file": run.file, "rows": run.len(), "duration_s": run.duration_s() }),
        );
    let json = json!({
        "format": 1,
        "recording": out,
        "roles": imported.roles,
        "guessed": imported.is_guessed,
        "runs": runs.collect::<Vec<_>>(),
        "notes": imported.notes,
        "warnings": warnings,
    });
    Answer {
        text: shown,
        json,
        problems: Vec::new(),
    }
}

/// The guessed columns and the resulting recording, as text.
pub fn shown(imported: &Imported) -> String {
    let mut text = String::new();
    let how = if imported.is_guessed {
        "  (guessed)"
    } else {
        ""
    };
    let _ = writeln!(text, "columns{how}");
    for role in &imported.roles {
        let _ = writeln!(text, "  {role}");
    }
    let runs = &imported.recording.runs;
    let _ = writeln!(
        text,
        "{} {}",
        runs.len(),
        if runs.len() == 1 { "run" } else { "runs" }
    );
    const SHOWN: usize = 10;
    for run in runs.iter().take(SHOWN) {
        let rate = run.len() as f64 / run.duration_s().max(f64::MIN_POSITIVE);
        let _ = writeln!(
            text,
            "  {}: {} rows, {:.3} s, {rate:.0} rows a second",
            run.file,
            run.len(),
            run.duration_s()
        );
    }
    if runs.len() > SHOWN {
        let _ = writeln!(text, "  and {} more", runs.len() - SHOWN);
    }
    for note in &imported.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// Asks the user at a terminal for confirmation. Without a terminal there is no question.
fn is_confirmed(shown: &str) -> bool {
    let input = std::io::stdin();
    if !input.is_terminal() {
        return true;
    }
    let mut out = std::io::stderr();
    let mut reply = String::new();
    // A user who cannot be asked or does not reply has not agreed.
    let asked = write!(out, "{shown}Is that right? [Y/n] ").and_then(|()| out.flush());
    let read = asked.and_then(|()| input.read_line(&mut reply));
    read.is_ok_and(|bytes| bytes > 0) && !reply.trim().to_lowercase().starts_with('n')
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let logs = self
            .logs
            .iter()
            .filter_map(|log| Target::of("LOG", Use::Read, log));
        logs.chain(Target::of("--out", Use::NewFolder, &self.out))
            .collect()
    }
}

impl Columns {
    fn recipe(&self) -> Result<Recipe, Failure> {
        Ok(Recipe {
            time: self.time.clone(),
            rate_hz: self.rate,
            input: self.input.clone(),
            position: self.position.clone(),
            velocity: self.velocity.clone(),
            setpoint: self.setpoint.clone(),
            further: self.column.clone(),
            counts_per_turn: self.counts_per_turn,
            resolution: self.resolution,
            noise: self.noise,
            wrap: self.wrap,
            position_sign_bit: self.position_sign_bit,
            input_sign_bit: self.input_sign_bit,
            input_bits: self.input_bits,
            input_is_of_instant: self.input_of_instant,
            tick_s: self.tick,
            undo_low_pass_hz: self.undo_low_pass,
            pid: self.pid_law()?,
            keep_s: self.keep,
            split_gap_s: self.split_gap,
            split_by: self.split_by.clone(),
            is_closed_loop: self.closed_loop,
            horizon_s: self.horizon,
            title: self.title.clone(),
        })
    }

    fn pid_law(&self) -> Result<Option<PidLaw>, Failure> {
        let Some(text) = &self.pid else {
            return Ok(None);
        };
        let wrong = || {
            ImportError::Option(format!(
                "--pid '{text}' is not understood; write 'kp=0.05,ki=0,kd=0.001'"
            ))
        };
        let mut law = PidLaw {
            kp: "0".into(),
            ki: "0".into(),
            kd: "0".into(),
            limit: self.limit,
            on: self
                .on
                .iter()
                .map(|text| switch_on(text))
                .collect::<Result<_, _>>()?,
        };
        for part in text.split(',') {
            let (name, gain) = part.split_once('=').ok_or_else(wrong)?;
            let place = match name.trim() {
                "kp" => &mut law.kp,
                "ki" => &mut law.ki,
                "kd" => &mut law.kd,
                _ => return Err(wrong().into()),
            };
            gain.trim().clone_into(place);
        }
        Ok(Some(law))
    }
}

fn switch_on(text: &str) -> Result<SwitchOn, ImportError> {
    match text {
        "found" => Ok(SwitchOn::Found),
        time => time.parse().map(SwitchOn::At).map_err(|_| {
            ImportError::Option(format!(
                "--on '{time}' is no time; give seconds of the log's clock, or `found`"
            ))
        }),
    }
}

fn span(text: &str) -> Result<[f64; 2], String> {
    let ends = text
        .split_once("..")
        .and_then(|(from, to)| Some([from.trim().parse().ok()?, to.trim().parse().ok()?]));
    match ends {
        Some([from, to]) if from < to => Ok([from, to]),
        _ => Err("write FROM..TO in s, as in -0.15..0.6".into()),
    }
}
