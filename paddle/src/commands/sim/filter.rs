//! `paddle sim filter`: shows the effect of the low-pass on the position (report, section 3.2.2).

use super::rig::{GainChoice, Rig, SensorChoice};
use crate::answer::{Answer, short};
use crate::failure::Failure;
use crate::files::Folder;
use crate::numbers;
use crate::plot::{Bar, Bars, Figure, Ink, Line, Panel, Scale};
use crate::spectrum;
use crate::targets::{Target, Use};
use clap::Args;
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::DerivativeSource;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::experiment::{Experiment, Trace};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example: paddle sim filter --kd 0.0008 --json filter.json

Torque noise is the rms of what lies above 25 Hz in the torque while the paddle follows a sine of 5°, 0.5 Hz.
A derivative gain is stable if the paddle follows that sine without a fault and with a torque noise below a tenth of
the torque limit: an unstable loop swings from limit to limit. The largest one is found by bisection to 1 %."
)]
pub struct Arguments {
    /// Derivative gain at which the torque noise is measured, N m s per degree at the paddle.
    #[arg(long, default_value_t = 0.0008, value_name = "N m s/deg", value_parser = numbers::setting)]
    kd: f32,
    /// Cutoff frequency of the filter, Hz.
    #[arg(long, default_value_t = 100.0, value_name = "Hz", value_parser = numbers::setting)]
    cutoff: f32,
    /// Simulate the 20 kHz current loop with bridge and winding, instead of the lab's 350 µs loop with an ideal torque.
    #[arg(long)]
    current_loop: bool,
    /// Write the plots to this folder.
    #[arg(long, default_value = "paddle-out", value_name = "DIR")]
    out: PathBuf,
}

/// Result for one sensor, with or without the filter.
struct Case {
    label: String,
    sensor: &'static str,
    cutoff_hz: f32,
    noise_nm: f64,
    spectrum: Vec<(f64, f64)>,
    largest_kd: Option<f64>,
}

/// Compares the sensors with and without the filter.
///
/// # Errors
/// Returns a [`Failure`] if a gain is invalid, or if a file cannot be written.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let mut cases = Vec::new();
    for (choice, sensor) in [
        (SensorChoice::Encoder, "encoder"),
        (SensorChoice::Hall, "Hall"),
    ] {
        for cutoff_hz in [0.0, arguments.cutoff] {
            cases.push(case(arguments, choice, sensor, cutoff_hz)?);
        }
    }
    let mut folder = Folder::new(&arguments.out);
    folder.draw("filter-noise.svg", noise_figure(&cases).svg());
    folder.draw("filter-largest-kd.svg", largest_kd_figure(&cases).svg());

    let mut text = format!(
        "{:<24} {:>26} {:>30}\n",
        "", "torque noise, mN m rms", "largest stable Kd, N m s/deg"
    );
    for case in &cases {
        let largest = case
            .largest_kd
            .map_or("none".into(), |kd| format!("{kd:.5}"));
        let _ = writeln!(
            text,
            "{:<24} {:>26.3} {largest:>30}",
            case.label,
            1e3 * case.noise_nm
        );
    }
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    let rows: Vec<_> = cases
        .iter()
        .map(|case| {
            json!({
                "sensor": case.sensor,
                "cutoff_hz": short(case.cutoff_hz),
                "torque_noise_nm": case.noise_nm,
                "largest_stable_kd_nm_s_per_deg": case.largest_kd,
            })
        })
        .collect();
    Ok(Answer {
        text,
        json: json!({
            "kd_nm_s_per_deg": short(arguments.kd),
            "current_loop": arguments.current_loop,
            "cases": rows,
            "files": folder.files(),
        }),
        problems: folder.lost(),
    })
}

impl Arguments {
    /// Paths that the command writes.
    pub fn targets(&self) -> Vec<Target<'_>> {
        Target::of("--out", Use::NewFolder, &self.out)
            .into_iter()
            .collect()
    }
}

fn case(
    arguments: &Arguments,
    choice: SensorChoice,
    sensor: &'static str,
    cutoff_hz: f32,
) -> Result<Case, Failure> {
    let with_kd = |kd: f32| {
        let rig = Rig {
            sensor: Some(choice),
            cutoff: Some(cutoff_hz),
            current_loop: arguments.current_loop,
            ..Rig::default()
        };
        let gains = GainChoice {
            kd: Some(kd),
            ..GainChoice::default()
        };
        let mut setup = rig.assemble()?.setup;
        gains.apply(&mut setup.settings)?;
        // The observer has its own filter, so it is not used here.
        setup.settings.pid.derivative = DerivativeSource::Position;
        Ok::<_, Failure>(setup)
    };
    let setup = with_kd(arguments.kd)?;
    let torque_nm = follow(&setup)?.input_nm;
    let sample_hz = 1.0 / setup.rates.position_tick_s();
    let mut largest_kd = None;
    let [mut stable, mut unstable] = KD_RANGE;
    if is_stable(&with_kd(stable as f32)?)? {
        while unstable / stable > KD_PRECISION {
            let middle = (stable * unstable).sqrt();
            match is_stable(&with_kd(middle as f32)?)? {
                true => stable = middle,
                false => unstable = middle,
            }
        }
        largest_kd = Some(stable);
    }
    Ok(Case {
        label: match cutoff_hz > 0.0 {
            true => format!("{sensor}, {cutoff_hz} Hz"),
            false => format!("{sensor}, no filter"),
        },
        sensor,
        cutoff_hz,
        noise_nm: noise_nm(&torque_nm, sample_hz),
        spectrum: spectrum::amplitude_density(&torque_nm, sample_hz, SEGMENT),
        largest_kd,
    })
}

/// Range of the search for the largest stable derivative gain, N m s per degree.
const KD_RANGE: [f64; 2] = [0.0001, 0.1];
/// Ratio of an unstable gain to a stable gain at which the search ends.
const KD_PRECISION: f64 = 1.01;
const SEGMENT: usize = 512;

const FOLLOWED_DEG: f32 = 5.0;
const FOLLOWED_HZ: f32 = 0.5;
const FOLLOWED_S: f64 = 4.0;
/// Lower limit of the torque noise in frequency.
const NOISE_FROM_HZ: f64 = 25.0;

/// Root mean square of the signal above about [`NOISE_FROM_HZ`] (f). A moving average over 1 / (2 f) is subtracted from the
/// signal. The average has its first zero at 2 f, and the difference has a gain of about one half at f.
fn noise_nm(torque_nm: &[f64], sample_hz: f64) -> f64 {
    let half = (sample_hz / (4.0 * NOISE_FROM_HZ)) as usize;
    let windows = torque_nm.windows(2 * half + 1);
    let count = windows.len().max(1) as f64;
    let power: f64 = windows
        .map(|window| {
            let mean = window.iter().sum::<f64>() / window.len() as f64;
            (window[half] - mean).powi(2)
        })
        .sum();
    (power / count).sqrt()
}

/// A loop counts as stable if its torque noise is below this share of the torque limit.
const STABLE_SHARE: f64 = 0.1;

fn is_stable(setup: &LoopSetup) -> Result<bool, Failure> {
    let trace = follow(setup)?;
    let limit_nm = f64::from(setup.settings.motor.torque_limit_nm);
    let noise_nm = noise_nm(&trace.input_nm, 1.0 / setup.rates.position_tick_s());
    Ok(trace.fault.is_none() && noise_nm < STABLE_SHARE * limit_nm)
}

fn follow(setup: &LoopSetup) -> Result<Trace, Failure> {
    let sine = Excitation::sine(FOLLOWED_DEG.to_radians(), FOLLOWED_HZ);
    let mut closed_loop = ClosedLoop::armed(setup, Mode::Position)?;
    Ok(Experiment::position(sine, FOLLOWED_S).run(&mut closed_loop)?)
}

fn ink(place: usize) -> Ink {
    match place {
        0 => Ink::Measured,
        1 => Ink::Model,
        other => Ink::Other(other - 2),
    }
}

fn noise_figure(cases: &[Case]) -> Figure {
    Figure {
        title: "Torque at the motor while following a sine of 5°, 0.5 Hz".into(),
        x_label: "frequency, Hz".into(),
        x_scale: Scale::Logarithmic,
        x_ticks: Vec::new(),
        panels: vec![Panel {
            y_label: "amplitude density, mN m/√Hz".into(),
            y_scale: Scale::Logarithmic,
            lines: cases
                .iter()
                .enumerate()
                .map(|(place, case)| Line {
                    label: case.label.clone(),
                    ink: ink(place),
                    points: case.spectrum.iter().map(|(f, d)| (*f, 1e3 * d)).collect(),
                })
                .collect(),
            ..Panel::default()
        }],
    }
}

fn largest_kd_figure(cases: &[Case]) -> Bars {
    Bars {
        title: "Largest stable derivative gain".into(),
        unit: "mN m s/°".into(),
        bars: cases
            .iter()
            .enumerate()
            .map(|(place, case)| Bar {
                label: case.label.clone(),
                value: 1e3 * case.largest_kd.unwrap_or(0.0),
                ink: ink(place),
            })
            .collect(),
    }
}
