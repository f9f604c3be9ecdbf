//! `paddle sim step` and the other excitations: simulates one experiment, and writes its plot and its log.

use super::rig::{Assembly, GainChoice, Rig, gains};
use crate::answer::{Answer, short};
use crate::failure::Failure;
use crate::files::{self, Folder};
use crate::numbers;
use crate::plot::{Figure, Ink, Line, Panel, step_response};
use crate::targets::{Target, Use};
use clap::Args;
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, Shape};
use haptic_paddle::metrics::StepReport;
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::experiment::{self, Experiment, Trace};
use recording::{Model, Recording};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of the experiment.
#[derive(Args, Clone, Debug)]
#[command(allow_negative_numbers = true)]
pub struct Arguments {
    #[command(flatten)]
    rig: Rig,
    #[command(flatten)]
    gains: GainChoice,
    /// Open loop: the excitation is a torque. A ramp is always a torque.
    #[arg(long)]
    torque: bool,
    /// Amplitude of the excitation: degrees, or N m at the motor with --torque [default: 10, or 0.0011; ramp 0.003].
    #[arg(long, value_parser = numbers::finite)]
    amplitude: Option<f64>,
    /// Offset of the excitation, in the unit of the amplitude.
    #[arg(long, default_value_t = 0.0, value_parser = numbers::finite)]
    offset: f64,
    /// Frequency of a wave, first frequency of a chirp, or fundamental of a multisine.
    #[arg(long, default_value_t = 1.0, value_name = "Hz", value_parser = numbers::positive)]
    frequency: f64,
    /// Last frequency of a chirp.
    #[arg(long, default_value_t = 20.0, value_name = "Hz", value_parser = numbers::positive)]
    end_frequency: f64,
    /// Duration [default: 0.5 for a step, 3 for other excitations].
    #[arg(long, value_name = "s", value_parser = numbers::positive)]
    seconds: Option<f64>,
    /// Rows per second of the CSV and of the recording [default: every period of the position loop].
    #[arg(long, value_name = "Hz", value_parser = numbers::positive)]
    log_rate: Option<f64>,
    /// Write the plot and the CSV to this folder.
    #[arg(long, default_value = "paddle-out", value_name = "DIR")]
    out: PathBuf,
    /// Write a recording to this folder, for `paddle gap`.
    #[arg(long, value_name = "DIR")]
    recording: Option<PathBuf>,
    /// Prediction window that the recording states.
    #[arg(long, default_value_t = 0.5, value_name = "s", value_parser = numbers::positive)]
    horizon: f64,
}

const STEP_S: f64 = 0.5;
const WAVE_S: f64 = 3.0;
const AMPLITUDE_DEG: f64 = 10.0;
const AMPLITUDE_NM: f64 = 0.0011;
const RAMP_NM: f64 = 0.003;

/// Simulates the experiment.
///
/// # Errors
/// Returns a [`Failure`] if the options contradict each other, or if a file cannot be written.
pub fn run(shape: Shape, arguments: &Arguments) -> Result<Answer, Failure> {
    let Assembly {
        mut setup,
        model,
        warnings,
    } = arguments.rig.assemble()?;
    arguments.gains.apply(&mut setup.settings)?;
    let experiment = arguments.experiment(shape);
    if arguments.recording.is_some() {
        horizon_fits(arguments.horizon, experiment.duration_s)?;
    }
    let mut closed_loop = ClosedLoop::armed(&setup, experiment.mode)?;
    let trace = experiment.run(&mut closed_loop)?;
    let controller = closed_loop.controller();
    let name = name(shape);
    let title = arguments.title(shape, &setup.settings);

    let mut text = format!("{warnings}{title}\n");
    let mut result = json!({
        "experiment": name,
        "title": title,
        "gains": gains(&setup.settings),
        "rig": arguments.rig.json(&setup),
        "seconds": experiment.duration_s,
    });
    if let Some(report) = controller.metrics() {
        text.push_str(&table(&report, &setup.settings));
        result["metrics"] = metrics(&report);
    }
    if shape == Shape::Ramp {
        let torque_nm = controller.breakaway();
        let _ = match torque_nm {
            Some(torque_nm) => writeln!(
                text,
                "  breaks away at {:.3} mN m at the motor",
                1e3 * torque_nm
            ),
            None => writeln!(text, "  does not break away; raise --amplitude"),
        };
        result["breakaway_nm"] = json!(torque_nm.map(short));
    }
    let range_deg = range_deg(&trace);
    let _ = writeln!(
        text,
        "  position      {:>8.2} to {:.2}°",
        range_deg[0], range_deg[1]
    );
    result["position_deg"] = json!(range_deg);
    if let Some((time_s, fault)) = trace.fault {
        let _ = writeln!(text, "  stopped at {:.1} ms: {fault}", 1e3 * time_s);
        result["fault"] = json!({ "time_s": time_s, "cause": fault.to_string() });
    }

    let mut folder = Folder::new(&arguments.out);
    folder.draw(
        format!("{name}.svg"),
        figure(&trace, &setup.settings, controller.metrics(), title).svg(),
    );
    folder.put(format!("{name}.csv"), &log(&trace));
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    result["files"] = json!(folder.files());
    let mut problems = folder.lost();
    if let Some(path) = &arguments.recording {
        match leave_recording(path, &arguments.recorded(name, &trace, &setup, model)) {
            Ok(()) => {
                let _ = writeln!(text, "  recording in {}", path.display());
                result["recording"] = json!(path);
            }
            Err(failure) => problems.push(failure),
        }
    }
    Ok(Answer {
        text,
        json: result,
        problems,
    })
}

/// Simulates the default step on the refitted paddle and writes its files to `out`.
///
/// # Errors
/// Returns a [`Failure`] if a file cannot be written.
pub fn step_of_refit(out: &Path) -> Result<Answer, Failure> {
    let arguments = Arguments {
        rig: Rig::default(),
        gains: GainChoice::default(),
        torque: false,
        amplitude: None,
        offset: 0.0,
        frequency: 0.0,
        end_frequency: 0.0,
        seconds: None,
        log_rate: None,
        out: out.to_owned(),
        recording: None,
        horizon: 0.0,
    };
    run(Shape::Step, &arguments)
}

/// Checks that a recording of `duration_s` is at least as long as a prediction window.
///
/// # Errors
/// Returns [`Failure::Setting`] if it is shorter.
fn horizon_fits(horizon_s: f64, duration_s: f64) -> Result<(), Failure> {
    if horizon_s <= duration_s {
        return Ok(());
    }
    Err(Failure::Setting(format!(
        "--horizon {horizon_s}: the recording lasts {duration_s} s, less than one prediction window; record longer with --seconds, or give a shorter one"
    )))
}

/// Writes a recording that `paddle gap` can read.
///
/// # Errors
/// Returns a [`Failure`] if `paddle gap` could not use the recording, which is then not written, or if the folder cannot be
/// written.
pub fn leave_recording(path: &Path, recording: &Recording) -> Result<(), Failure> {
    recording.validate()?;
    if path.join("recording.toml").exists() {
        return Err(Failure::HoldsRecording(path.to_owned()));
    }
    Ok(recording.write(path)?)
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let plant = Target::of("--plant", Use::Read, self.rig.plant.file());
        let out = Target::of("--out", Use::NewFolder, &self.out);
        let recording = Target::of("--recording", Use::NewFolder, self.recording.as_ref());
        [plant, out, recording].into_iter().flatten().collect()
    }

    fn title(&self, shape: Shape, settings: &Settings) -> String {
        let (excitation, unit, per) = match self.experiment(shape) {
            Experiment {
                excitation: None, ..
            } => return self.rig.title(settings),
            Experiment {
                excitation: Some(excitation),
                mode: Mode::Position,
                ..
            } => (excitation, "°", 1f32.to_degrees()),
            Experiment {
                excitation: Some(excitation),
                ..
            } => (excitation, " mN m", 1e3),
        };
        let amplitude = (f64::from(excitation.amplitude * per) * 1e3).round() / 1e3;
        let mut title = name(shape).to_owned();
        title[..1].make_ascii_uppercase();
        let _ = write!(title, " of {amplitude}{unit}");
        if !matches!(shape, Shape::Step | Shape::Ramp) {
            let _ = write!(title, ", {} Hz", self.frequency);
        }
        if shape == Shape::Chirp {
            let _ = write!(title, " to {} Hz", self.end_frequency);
        }
        format!("{title}: {}", self.rig.title(settings))
    }

    fn mode(&self, shape: Shape) -> Mode {
        match self.torque || shape == Shape::Ramp {
            true => Mode::Torque,
            false => Mode::Position,
        }
    }

    fn experiment(&self, shape: Shape) -> Experiment {
        let mode = self.mode(shape);
        let (unit, amplitude) = match mode {
            Mode::Position => (1f64.to_radians(), AMPLITUDE_DEG),
            _ if shape == Shape::Ramp => (1.0, RAMP_NM),
            _ => (1.0, AMPLITUDE_NM),
        };
        let duration_s = self.seconds.unwrap_or(match shape {
            Shape::Step => STEP_S,
            _ => WAVE_S,
        });
        let needs_end = matches!(shape, Shape::Chirp | Shape::Ramp);
        let excitation = Excitation {
            shape,
            amplitude: (self.amplitude.unwrap_or(amplitude) * unit) as f32,
            offset: (self.offset * unit) as f32,
            frequency_hz: self.frequency as f32,
            end_frequency_hz: self.end_frequency as f32,
            duration_s: if needs_end { duration_s as f32 } else { 0.0 },
        };
        Experiment {
            mode,
            log_hz: self.log_rate.unwrap_or(f64::INFINITY),
            ..Experiment::position(excitation, duration_s)
        }
    }

    fn recorded(&self, name: &str, trace: &Trace, setup: &LoopSetup, model: Model) -> Recording {
        let title = format!("Simulated {name}");
        let mut recording = experiment::recording(title, self.horizon, model, setup);
        let mut run = trace.to_run(format!("{name}.csv"), setup);
        for column in [&mut run.time, &mut run.input, &mut run.position]
            .into_iter()
            .chain(run.setpoint.as_mut())
            .chain(run.positions.values_mut())
        {
            for value in column {
                *value = files::logged(*value);
            }
        }
        recording.runs.push(run);
        recording
    }
}

fn name(shape: Shape) -> &'static str {
    let named = Shape::NAMED.iter().find(|(_, other)| *other == shape);
    named.map_or("experiment", |(name, _)| name)
}

/// The metrics as text.
pub fn table(report: &StepReport, settings: &Settings) -> String {
    let time = |seconds: Option<f32>| match seconds {
        Some(seconds) => format!("{:>8.1} ms", 1e3 * seconds),
        None => format!("{:>8}", "never"),
    };
    format!(
        "  overshoot     {:>8.2}°\n  rise          {}\n  settling      {} (±{}°)\n  rest error    {:>8.3}°\n",
        report.overshoot_rad.to_degrees(),
        time(report.rise_s),
        time(report.settling_s),
        settings.metrics.band_deg,
        report.steady_state_error_rad.to_degrees(),
    )
}

/// The metrics as JSON. A time that is never reached is null.
pub fn metrics(report: &StepReport) -> Value {
    let ms = |seconds: Option<f32>| seconds.map(|s| short(1e3 * s));
    json!({
        "overshoot_deg": short(report.overshoot_rad.to_degrees()),
        "rise_ms": ms(report.rise_s),
        "settling_ms": ms(report.settling_s),
        "steady_state_error_deg": short(report.steady_state_error_rad.to_degrees()),
    })
}

fn range_deg(trace: &Trace) -> [f64; 2] {
    let fold = |pick: fn(f64, f64) -> f64| trace.position_rad.iter().copied().reduce(pick);
    [fold(f64::min), fold(f64::max)].map(|end| end.unwrap_or(0.0).to_degrees())
}

fn scaled(values: &[f64], scale: f64) -> Vec<f64> {
    values.iter().map(|v| v * scale).collect()
}

/// Longest plot with a time axis in ms, s.
const MILLISECONDS_UP_TO: f64 = 2.0;

fn figure(trace: &Trace, settings: &Settings, step: Option<StepReport>, title: String) -> Figure {
    let deg = 1f64.to_degrees();
    let measured = match settings.estimate.sensor {
        Sensor::Encoder => &trace.encoder_rad,
        Sensor::Hall => &trace.hall_rad,
    };
    let in_ms = step.is_some() || trace.time_s.last() <= Some(&MILLISECONDS_UP_TO);
    let (x_label, per_s) = if in_ms {
        ("time, ms", 1e3)
    } else {
        ("time, s", 1.0)
    };
    let time = scaled(&trace.time_s, per_s);
    let position = match step {
        // The metrics refer to the filtered position, so the plot shows the filtered position.
        Some(report) => {
            let points = time
                .iter()
                .copied()
                .zip(scaled(&trace.regulated_rad, deg))
                .collect();
            let target_deg = trace.setpoint_rad.last().copied().unwrap_or(0.0) * deg;
            step_response(
                points,
                target_deg,
                f64::from(settings.metrics.band_deg),
                &report,
            )
        }
        None => {
            let setpoint = Line::new(
                "setpoint",
                Ink::Setpoint,
                &time,
                &scaled(&trace.setpoint_rad, deg),
            );
            let measured = Line::new("position", Ink::Measured, &time, &scaled(measured, deg));
            Panel {
                y_label: "position, degrees".into(),
                lines: match trace.mode {
                    Mode::Position => vec![setpoint, measured],
                    _ => vec![measured],
                },
                ..Panel::default()
            }
        }
    };
    let torque = Line::new("torque", Ink::Model, &time, &scaled(&trace.input_nm, 1e3));
    Figure {
        title,
        x_label: x_label.into(),
        panels: vec![
            position,
            Panel {
                y_label: "torque at the motor, mN m".into(),
                lines: vec![torque],
                ..Panel::default()
            },
        ],
        ..Figure::default()
    }
}

fn log(trace: &Trace) -> String {
    let deg = 1f64.to_degrees();
    let wide = |values: &[f32]| values.iter().map(|v| f64::from(*v)).collect::<Vec<_>>();
    files::csv(&[
        ("time_s", &trace.time_s),
        ("setpoint_deg", &scaled(&trace.setpoint_rad, deg)),
        ("position_deg", &scaled(&trace.position_rad, deg)),
        ("encoder_deg", &scaled(&trace.encoder_rad, deg)),
        ("hall_deg", &scaled(&trace.hall_rad, deg)),
        ("filtered_deg", &scaled(&trace.regulated_rad, deg)),
        ("torque_nm", &trace.input_nm),
        ("current_a", &wide(&trace.current_a)),
        ("duty", &wide(&trace.duty)),
    ])
}
