//! `paddle sim tune`: finds gains that meet a specification.

use super::experiment::metrics;
use super::rig::{Assembly, Rig};
use crate::answer::Answer;
use crate::failure::Failure;
use crate::files::Folder;
use crate::numbers;
use crate::plot::{Band, Figure, Ink, Line, Panel};
use crate::targets::{Target, Use};
use crate::tuning::assessment::{Bench, Case, met};
use crate::tuning::search;
use crate::tuning::specification::Specification;
use crate::tuning::spread::Variant;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Options of the command.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  paddle sim tune --plant refit
  paddle gap diagnose my-recording --save-model corrected.toml
  paddle sim tune --plant corrected.toml
  paddle sim tune --plant refit --current-loop --settling 150 --friction-spread 50

The gains are those that make the least torque of the sensor's noise while the known paddle and the corners of the spread
keep a tenth of every bound in reserve. Held off is how far from the target dry friction and weight can hold the paddle
at the end of the settling time. Steps are simulated through the control core. The margins are those of the loop
without dry friction, play and compensations; the part of the core and of the current loop is measured on them. The
lines with `set` can be typed into the console. The exit status is 1 if no gains meet the specification.")]
pub struct Arguments {
    #[command(flatten)]
    rig: Rig,
    /// Amplitude of the step, degrees.
    #[arg(long, default_value_t = 10.0, value_name = "deg", value_parser = numbers::finite)]
    amplitude: f64,
    /// Largest overshoot, per cent of the step.
    #[arg(long, default_value_t = 25.0, value_name = "%", value_parser = numbers::finite)]
    overshoot: f64,
    /// Longest rise time: time to the first crossing of the target.
    #[arg(long, default_value_t = 100.0, value_name = "ms", value_parser = numbers::finite)]
    rise: f64,
    /// Longest settling time: time until the position stays within `metrics.band` of the target.
    #[arg(long, default_value_t = 350.0, value_name = "ms", value_parser = numbers::finite)]
    settling: f64,
    /// Smallest gain margin.
    #[arg(long, default_value_t = 6.0, value_name = "dB", value_parser = numbers::finite)]
    gain_margin: f64,
    /// Smallest phase margin.
    #[arg(long, default_value_t = 30.0, value_name = "deg", value_parser = numbers::finite)]
    phase_margin: f64,
    /// Largest deviation of dry and viscous friction from the plant's values, in both directions.
    #[arg(long, default_value_t = 30.0, value_name = "%", value_parser = numbers::finite)]
    friction_spread: f64,
    /// Largest deviation of the inertia from the plant's value, in both directions.
    #[arg(long, default_value_t = 10.0, value_name = "%", value_parser = numbers::finite)]
    inertia_spread: f64,
    /// Write a plot to this folder.
    #[arg(long, default_value = "paddle-out", value_name = "DIR")]
    out: PathBuf,
}

/// Finds the gains.
///
/// # Errors
/// Returns a [`Failure`] if the loop or the specification is invalid.
pub fn run(arguments: &Arguments) -> Result<Answer, Failure> {
    let Assembly {
        setup, warnings, ..
    } = arguments.rig.assemble()?;
    let band_deg = in_decimals(setup.settings.metrics.band_deg);
    let (specification, variants) = arguments.demands(band_deg)?;
    let bench = Bench::new(&setup, specification, arguments.amplitude, &variants)?;
    let gains = search::least(|gains| bench.cost(gains))?.rounded();
    let cases = bench.cases(&gains)?;
    let meets = met(&cases);

    let title = format!("Tuned: {}", arguments.rig.title(&setup.settings));
    let mut folder = Folder::new(&arguments.out);
    let figure = figure(
        &title,
        &cases,
        [arguments.amplitude, band_deg],
        arguments.settling,
    );
    folder.draw("tune.svg", figure.svg());

    let mut text = format!("{warnings}{title}\n\n{}\n", gains.lines());
    text.push_str(&arguments.table(&cases, band_deg));
    for file in folder.files() {
        let _ = writeln!(text, "  {}", file.display());
    }
    Ok(Answer {
        text,
        json: json!({
            "title": title,
            "gains": gains.json(),
            "console": gains.lines().lines().collect::<Vec<_>>(),
            "meets": meets,
            "cases": cases.iter().map(case).collect::<Vec<_>>(),
            "rig": arguments.rig.json(&setup),
            "files": folder.files(),
        }),
        problems: (!meets)
            .then_some(Failure::OutOfReach)
            .into_iter()
            .chain(folder.lost())
            .collect(),
    })
}

impl Arguments {
    /// Paths that the command writes, and paths that it must not overwrite.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let plant = Target::of("--plant", Use::Read, self.rig.plant.file());
        let out = Target::of("--out", Use::NewFolder, &self.out);
        [plant, out].into_iter().flatten().collect()
    }

    /// The specification, and the paddles that must meet it.
    fn demands(&self, band_deg: f64) -> Result<(Specification, Vec<Variant>), Failure> {
        let positive = [
            ("--amplitude", self.amplitude),
            ("--overshoot", self.overshoot),
            ("--rise", self.rise),
            ("--settling", self.settling),
            ("--gain-margin", self.gain_margin),
            ("--phase-margin", self.phase_margin),
        ];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Failure::Setting(format!(
                    "{name} is {value}; it must be above 0"
                )));
            }
        }
        let spreads = [
            ("--friction-spread", self.friction_spread),
            ("--inertia-spread", self.inertia_spread),
        ];
        for (name, value) in spreads {
            if !(0.0..100.0).contains(&value) {
                return Err(Failure::Setting(format!(
                    "{name} is {value}; it must be 0 or more, and below 100 %"
                )));
            }
        }
        let specification = Specification {
            overshoot_share: self.overshoot / 100.0,
            rise_s: self.rise / 1e3,
            settling_s: self.settling / 1e3,
            band_deg,
            gain_margin_db: self.gain_margin,
            phase_margin_deg: self.phase_margin,
        };
        let variants = Variant::of(self.friction_spread / 100.0, self.inertia_spread / 100.0);
        Ok((specification, variants))
    }

    /// Bounds on the step response and on the margins.
    fn bounds(&self, band_deg: f64) -> [Bound; 6] {
        let at_most = |name, unit, bound, of| Bound {
            name,
            unit,
            bound,
            side: Side::AtMost,
            of,
        };
        let at_least = |name, unit, bound, of| Bound {
            side: Side::AtLeast,
            ..at_most(name, unit, bound, of)
        };
        let overshoot_deg = self.overshoot / 100.0 * self.amplitude;
        [
            at_most("overshoot", "°", overshoot_deg, |case| {
                f64::from(case.trial.metrics.overshoot_rad.to_degrees())
            }),
            at_most("rise", "ms", self.rise, |case| {
                ms(case.trial.metrics.rise_s)
            }),
            at_most("settling", "ms", self.settling, |case| {
                ms(case.trial.metrics.settling_s)
            }),
            at_most("held off by", "°", band_deg, |case| case.rest_error_deg),
            at_least("gain margin", "dB", self.gain_margin, |case| {
                case.margins.map_or(f64::INFINITY, |m| m.gain_db)
            }),
            at_least("phase margin", "°", self.phase_margin, |case| {
                case.margins.map_or(f64::INFINITY, |m| m.phase_deg)
            }),
        ]
    }

    /// Table of the bounds, with the values for the known paddle and the worst values.
    fn table(&self, cases: &[Case], band_deg: f64) -> String {
        let mut text = format!(
            "{:<14} {:>12} {:>12}   friction ±{} %, inertia ±{} %\n",
            "", "this paddle", "at worst", self.friction_spread, self.inertia_spread
        );
        for bound in self.bounds(band_deg) {
            text.push_str(&bound.line(cases));
        }
        text
    }
}

/// Converts a setting to the decimal number that a user would type for it.
fn in_decimals(setting: f32) -> f64 {
    // The decimal form of a finite f32 always parses as an f64.
    setting.to_string().parse().unwrap_or(f64::from(setting))
}

fn ms(seconds: Option<f32>) -> f64 {
    seconds.map_or(f64::INFINITY, |s| 1e3 * f64::from(s))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    AtMost,
    AtLeast,
}

/// A bound on one quantity.
struct Bound {
    name: &'static str,
    unit: &'static str,
    bound: f64,
    side: Side,
    of: fn(&Case) -> f64,
}

impl Bound {
    /// The value for the known paddle, which is the first case, and the worst value.
    fn line(&self, cases: &[Case]) -> String {
        let values: Vec<_> = cases.iter().map(self.of).collect();
        let (worst, asked, missed) = match self.side {
            Side::AtMost => {
                let worst = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                (worst, "at most", worst > self.bound)
            }
            Side::AtLeast => {
                let worst = values.iter().copied().fold(f64::INFINITY, f64::min);
                (worst, "at least", worst < self.bound)
            }
        };
        let known = values.first().copied().unwrap_or(f64::NAN);
        let unit = match self.unit {
            "°" => "°".to_owned(),
            unit => format!(" {unit}"),
        };
        let shown = |value: f64| match value.is_finite() {
            true if value.abs() < 10.0 => format!("{value:.2}{unit}"),
            true => format!("{value:.1}{unit}"),
            false => "∞".into(),
        };
        format!(
            "{:<14} {:>12} {:>12}   {asked} {}{unit}{}\n",
            self.name,
            shown(known),
            shown(worst),
            self.bound,
            if missed { "  MISSED" } else { "" }
        )
    }
}

fn case(case: &Case) -> Value {
    json!({
        "friction": case.variant.friction,
        "inertia": case.variant.inertia,
        "metrics": metrics(&case.trial.metrics),
        "rest_error_bound_deg": case.rest_error_deg,
        "gain_margin_db": case.margins.map(|m| m.gain_db),
        "phase_margin_deg": case.margins.map(|m| m.phase_deg),
        "crossover_hz": case.margins.map(|m| m.crossover_hz),
        "meets": case.load <= 1.0,
    })
}

/// All steps in one plot, up to the required settling time.
fn figure(title: &str, cases: &[Case], [target_deg, band_deg]: [f64; 2], shown_ms: f64) -> Figure {
    let percent = |factor: f64| format!("{:+.0} %", 100.0 * (factor - 1.0));
    let lines = cases.iter().enumerate().map(|(place, case)| Line {
        label: match place {
            0 => "this paddle".into(),
            _ => format!(
                "friction {}, inertia {}",
                percent(case.variant.friction),
                percent(case.variant.inertia)
            ),
        },
        ink: match place {
            0 => Ink::Measured,
            other => Ink::Other(other - 1),
        },
        points: case
            .trial
            .points()
            .into_iter()
            .take_while(|(ms, _)| *ms <= shown_ms)
            .collect(),
    });
    Figure {
        title: title.into(),
        x_label: "time, ms".into(),
        panels: vec![Panel {
            y_label: "position, degrees".into(),
            band: Some(Band {
                from: target_deg - band_deg,
                to: target_deg + band_deg,
            }),
            lines: lines.collect(),
            ..Panel::default()
        }],
        ..Figure::default()
    }
}
