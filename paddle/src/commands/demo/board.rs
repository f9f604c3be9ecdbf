//! Demonstration without hardware. A virtual board runs a paddle with a hidden effect; experiments identify the effect;
//! gains are tuned on the corrected model; and a step response is recorded before and after.

use crate::answer::Answer;
use crate::commands::{experiment, settings};
use crate::failure::Failure;
use crate::files::Folder;
use crate::interrupt::Interrupt;
use crate::plot::{Band, Figure, Ink, Line, Panel};
use crate::progress;
use crate::rig::{ROWS_HZ, Rig};
use crate::settings_file::{differences, told};
use host_sim::effects::Effect;
use link::Channel;
use remote::{Plan, Taken};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Lines};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

/// The experiment that is plotted: a position step in degrees and s.
const STEP: &str = "position:step:10,0.6";
const TARGET_DEG: f64 = 10.0;
/// Most paddle time for experiments, s.
const SECONDS: f64 = 60.0;

/// Runs the demonstration with the effect `hidden` in the paddle.
///
/// # Errors
/// Returns a [`Failure`] if the effect is unknown, if the board does not start, or if a file cannot be written.
pub fn run(out: &Path, hidden: &str) -> Result<Answer, Failure> {
    hidden.parse::<Effect>()?;
    let board = VirtualBoard::start(hidden)?;
    let before = step(&board.port)?;
    let found = experiment::run(&experiment::Arguments::on(
        board.port.clone(),
        out.join("experiment"),
        SECONDS,
    ))?;
    let corrected = out.join("experiment").join("corrected.toml");
    let gains = tuned(&corrected, &out.join("tune"))?;
    let changes = push(&board.port, &gains)?;
    let after = step(&board.port)?;

    let mut folder = Folder::new(out);
    folder.draw(
        "before-and-after.svg",
        figure(hidden, &before, &after).svg(),
    );
    let mut text = format!(
        "Hidden in the paddle: {hidden}\n\n{}\nGains for the corrected model, on the board now:\n{changes}",
        found.text
    );
    for (name, points) in [("before", &before), ("after", &after)] {
        let most = points
            .iter()
            .fold(f64::MIN, |most, (_, deg)| most.max(*deg));
        let end = points.last().map_or(0.0, |(_, deg)| *deg);
        text.push_str(&format!(
            "{name:<8} overshoot {:.2}°, at the end {:+.2}° from the target\n",
            (most - TARGET_DEG).max(0.0),
            end - TARGET_DEG
        ));
    }
    for file in folder.files() {
        text.push_str(&format!("  {}\n", file.display()));
    }
    Ok(Answer {
        text,
        json: json!({ "hidden": hidden, "diagnosis": found.json, "gains": gains, "files": folder.files() }),
        problems: found.problems.into_iter().chain(folder.lost()).collect(),
    })
}

/// A virtual board in a process of its own, as a user would start it. Dropping the value ends the process.
struct VirtualBoard {
    child: Child,
    _lines: Lines<BufReader<ChildStdout>>,
    port: String,
}

impl VirtualBoard {
    fn start(hidden: &str) -> Result<Self, Failure> {
        progress::doing("starting the virtual board".into());
        let failed = |error: std::io::Error| Failure::Board(format!("no virtual board: {error}"));
        let mut child = Command::new(std::env::current_exe().map_err(failed)?)
            .args(["board", "--plant", "nominal", "--with", hidden])
            .stdout(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let lines = child.stdout.take().map(|out| BufReader::new(out).lines());
        let Some(mut lines) = lines else {
            return Err(Failure::Board("the virtual board says nothing".into()));
        };
        let port = lines
            .by_ref()
            .map_while(Result::ok)
            .find_map(|line| line.strip_prefix("serial port: ").map(str::to_owned));
        match port {
            Some(port) => Ok(Self {
                child,
                _lines: lines,
                port,
            }),
            None => {
                let _ = child.wait();
                Err(Failure::Board(
                    "the virtual board did not start; what it said stands above".into(),
                ))
            }
        }
    }
}

impl Drop for VirtualBoard {
    fn drop(&mut self) {
        // The board's process has no output to save.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Records the step response of the board: time since the step, ms, and position, degrees.
fn step(port: &str) -> Result<Vec<(f64, f64)>, Failure> {
    let plan: Plan = STEP
        .parse()
        .map_err(|error: remote::PlanError| Failure::Board(error.to_string()))?;
    let mut rig = Rig::open(port)?;
    let taken = rig.take(&plan, ROWS_HZ, &Interrupt::watched()?)?;
    rig.leave()?;
    Ok(points(&taken))
}

fn points(taken: &Taken) -> Vec<(f64, f64)> {
    let high = |row: &&remote::Row| row.value(Channel::Setpoint) > 0.1;
    let up: Vec<_> = taken
        .rows
        .iter()
        .skip_while(|row| !high(row))
        .take_while(high)
        .collect();
    let first = up.first().map_or(0, |row| row.period);
    up.iter()
        .map(|row| {
            let periods_per_ms = 20.0;
            (
                f64::from(row.period.wrapping_sub(first)) / periods_per_ms,
                f64::from(row.value(Channel::Encoder).to_degrees()),
            )
        })
        .collect()
}

/// Runs `paddle sim tune` on the saved model and returns its JSON.
fn tuned(model: &Path, out: &Path) -> Result<Value, Failure> {
    progress::doing("tuning on the corrected model".into());
    let failed = |error: std::io::Error| Failure::Board(format!("tuning failed: {error}"));
    let output = Command::new(std::env::current_exe().map_err(failed)?)
        .args(["sim", "tune", "--json", "-", "--plant"])
        .arg(model)
        .arg("--out")
        .arg(out)
        .stderr(Stdio::inherit())
        .output()
        .map_err(failed)?;
    // Exit status 1 means that no gains meet the specification. The best gains are then printed all the same.
    let told: Value = serde_json::from_slice(&output.stdout)
        .map_err(|error| Failure::Board(format!("tuning failed: {error}")))?;
    Ok(told["gains"].clone())
}

/// Writes gains to the board. Returns the changed settings as text.
fn push(port: &str, gains: &Value) -> Result<String, Failure> {
    let mut rig = Rig::open(port)?;
    let mut wanted = rig.settings;
    for (name, key) in [
        ("pid.kp", "kp_nm_per_deg"),
        ("pid.ki", "ki_nm_per_deg_s"),
        ("pid.kd", "kd_nm_s_per_deg"),
    ] {
        wanted
            .set(name, &gains[key].to_string())
            .map_err(|error| Failure::setting(name, error))?;
    }
    let changes = differences(&rig.settings, &wanted);
    settings::push(&mut rig.device, &changes)?;
    rig.leave()?;
    Ok(told(&changes))
}

fn figure(hidden: &str, before: &[(f64, f64)], after: &[(f64, f64)]) -> Figure {
    const BAND_DEG: f64 = 0.2;
    let line = |label: &str, ink, points: &[(f64, f64)]| Line {
        label: label.into(),
        ink,
        points: points.to_vec(),
    };
    Figure {
        title: format!("A step of the paddle with {hidden}"),
        x_label: "time, ms".into(),
        panels: vec![Panel {
            y_label: "position, degrees".into(),
            band: Some(Band {
                from: TARGET_DEG - BAND_DEG,
                to: TARGET_DEG + BAND_DEG,
            }),
            lines: vec![
                line("with the gains of the boot", Ink::Model, before),
                line("tuned on the corrected model", Ink::Measured, after),
            ],
            ..Panel::default()
        }],
        ..Figure::default()
    }
}

/// Folder of the board's files.
pub fn folder(out: &Path) -> PathBuf {
    out.join("board")
}
