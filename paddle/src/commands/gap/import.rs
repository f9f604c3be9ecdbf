//! `paddle gap import`: logs of other programs to a recording.

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

/// Which logs, and what their columns are.
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
    /// Logs: text in columns of any delimiter, packed or not; .npz, .mat, Parquet and MCAP if they were built in.
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Folder of the recording.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Do not ask whether the guesses are right.
    #[arg(long)]
    yes: bool,
    #[command(flatten)]
    columns: Columns,
    #[command(flatten)]
    known: KnownArguments,
}

/// What the columns are.
#[derive(Args)]
struct Columns {
    /// Time: a column, in s, ms, us, ns or as date and time, or a formula in s.
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Rows per second of a log without a column of time.
    #[arg(long, value_name = "HZ", conflicts_with = "time")]
    rate: Option<f64>,
    /// What the actuator was told.
    #[arg(long, value_name = "COLUMN")]
    input: Option<String>,
    /// Where the device was.
    #[arg(long, value_name = "COLUMN", conflicts_with = "velocity")]
    position: Option<String>,
    /// Its velocity, where no position was logged: the position is made as the integral.
    #[arg(long, value_name = "COLUMN")]
    velocity: Option<String>,
    /// Where it was to be.
    #[arg(long, value_name = "COLUMN")]
    setpoint: Option<String>,
    /// A further column of the recording: position_NAME, current, supply or temperature; may be repeated.
    #[arg(long, value_name = "NAME=COLUMN", value_parser = super::known::pair)]
    column: Vec<(String, String)>,
    /// Counts of the position in one turn.
    #[arg(long, value_name = "COUNTS")]
    counts_per_turn: Option<f64>,
    /// Quantum of the position, in its logged unit; left out, it is told from the readings.
    #[arg(long, value_name = "STEP")]
    resolution: Option<f64>,
    /// Standard deviation of the position's noise, in its logged unit; likewise.
    #[arg(long, value_name = "STD")]
    noise: Option<f64>,
    /// The position wraps around this span, in its logged unit; 0 if it does not.
    #[arg(long, value_name = "SPAN")]
    wrap: Option<f64>,
    /// Bit, from 0, that is the sign of the words of the position.
    #[arg(long, value_name = "BIT")]
    position_sign_bit: Option<u32>,
    /// Bit, from 0, that is the sign of the words of the input, as 10 in a load of 0 to 2047.
    #[arg(long, value_name = "BIT")]
    input_sign_bit: Option<u32>,
    /// The words of the input are two's complement of so many bits.
    #[arg(long, value_name = "BITS")]
    input_bits: Option<u32>,
    /// The input of a row is that of its instant, not the one that is held until the next row.
    #[arg(long)]
    input_of_instant: bool,
    /// Period of the device's own loop, s: formulas are averaged over its ticks until the next row.
    #[arg(long, value_name = "S")]
    tick: Option<f64>,
    /// The device applied a first-order low-pass of this corner to the logged position; undo it.
    #[arg(long, value_name = "HZ", requires = "tick")]
    undo_low_pass: Option<f64>,
    /// The input was not logged, but it is a PID's on the logged position: 'kp=0.05/15,ki=0,kd=Kd/15', per unit of the
    /// logged position, numbers or formulas of columns.
    #[arg(long, value_name = "GAINS", requires = "tick")]
    pid: Option<String>,
    /// The command of the PID is clipped at ± this.
    #[arg(long, value_name = "LIMIT", requires = "pid")]
    limit: Option<f64>,
    /// When the PID was switched on, log by log: times of the log's clock in s, or `found` for where the motion follows it
    /// best, which is uncertain by a tick or two.
    #[arg(long, value_name = "S|found", requires = "pid", value_delimiter = ',')]
    on: Vec<String>,
    /// Part of each run that is kept, in s from its begin, or from when the PID was switched on.
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true, value_parser = span)]
    keep: Option<[f64; 2]>,
    /// A new run begins after a gap of so many seconds.
    #[arg(long, value_name = "S")]
    split_gap: Option<f64>,
    /// A new run begins where this column changes.
    #[arg(long, value_name = "COLUMN")]
    split_by: Option<String>,
    /// The input is a controller's.
    #[arg(long)]
    closed_loop: bool,
    /// Length of a prediction window, s.
    #[arg(long, value_name = "S")]
    horizon: Option<f64>,
    /// A line for people.
    #[arg(long)]
    title: Option<String>,
}

/// Imports.
///
/// # Errors
/// [`Failure`] for logs that cannot be understood and a recording that cannot be used or written.
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

/// Puts a manifest beside its runs, and reads the whole; what is odd about it is returned.
///
/// # Errors
/// [`Failure`] if it cannot be written or used.
pub fn leave_manifest(folder: &Path, text: &str) -> Result<Vec<String>, Failure> {
    let path = folder.join("recording.toml");
    std::fs::write(&path, text).map_err(Failure::write(&path))?;
    Ok(recording::Recording::read(folder)?.warnings())
}

/// What is said of an import.
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
        amiss: Vec::new(),
    }
}

/// The guesses and what came of them, for people.
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

/// Whether a person at a terminal agrees; without one nobody is asked.
fn is_confirmed(shown: &str) -> bool {
    let input = std::io::stdin();
    if !input.is_terminal() {
        return true;
    }
    let mut out = std::io::stderr();
    let mut reply = String::new();
    // Who cannot be asked or does not reply has not agreed.
    let asked = write!(out, "{shown}Is that right? [Y/n] ").and_then(|()| out.flush());
    let read = asked.and_then(|()| input.read_line(&mut reply));
    read.is_ok_and(|bytes| bytes > 0) && !reply.trim().to_lowercase().starts_with('n')
}

impl Arguments {
    /// Where it will write, and what it must not write over.
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
