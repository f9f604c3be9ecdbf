//! Breakaway torque, and torque sines of 1 Hz: figures 3 and 4.

use super::row::Row;
use crate::failure::Failure;
use crate::plot::{Figure, Ink, Line, Panel};
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::{Excitation, Shape};
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::device::Device;
use host_sim::experiment::Experiment;
use host_sim::lab_model::{LabDrive, LabModel, LabSample, STEP_S};
use host_sim::presets;
use recording::{Recording, Run};
use std::f64::consts::TAU;

const FREQUENCY_HZ: f64 = 1.0;
const SECONDS: f64 = 30.0;
/// Torque amplitudes of figure 3 (low) and of figure 4 (high), N m at the motor.
const LOW_NM: f64 = 0.00101;
const HIGH_NM: f64 = 0.0011;
/// Larger torque amplitudes, N m at the motor.
const MORE_NM: [f64; 2] = [0.002, 0.005];
const PEAK_BAR_SHARE: f64 = 0.1;
/// Relative tolerance of the settling time: all later peaks are within this share of the last peak.
const SETTLED_SHARE: f64 = 0.15;
/// Time axis of the figures, s.
const SHOWN_S: f64 = 20.0;

/// Dry friction that the lab measured, N m at the motor.
const BREAKAWAY_NM: f64 = 0.001;
const BREAKAWAY_BAR_SHARE: f64 = 0.05;
/// The ramp is slow, so that the torque increases little while the paddle begins to move.
const RAMP_NM: f32 = 0.002;
const RAMP_S: f32 = 40.0;

const INERT: &str = "with its two slips: torque passes in every second step while it is above T0, else not, and friction acts \
                     above 20 rad/s, which is never";
const GENUINE: &str = "a friction that acts lets 1.1 mN m move the paddle by a degree: figure 4 is not the sign of one";
const NOT_READ: &str = "\"45°\" is read off a figure whose first peaks are 49.5 and −51.8°";
const OTHER_DAY: &str =
    "the paddle of the step logs has 0.63 mN m; cable tension changes it from day to day";

/// Time in s and angle in degrees.
type Points = Vec<(f64, f64)>;

/// The simulated sines and the recorded one.
pub struct Sinusoids {
    low: Vec<LabSample>,
    high: Vec<LabSample>,
    more_deg: [f64; 2],
    /// The nominal paddle with effective dry friction, at the lower and at the higher amplitude.
    genuine: [Points; 2],
    /// Recorded position of the real paddle.
    recorded: Option<Points>,
    breakaway_nm: [f64; 2],
}

impl Sinusoids {
    /// Simulates the sines. `recorded` is the lab's recording at the higher amplitude.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses.
    pub fn run(recorded: Option<&Recording>) -> Result<Self, Failure> {
        let sine = |amplitude_nm| {
            let drive = LabDrive::Sine {
                amplitude_nm,
                frequency_hz: FREQUENCY_HZ,
            };
            LabModel::at_rest(presets::nominal(), drive).run(SECONDS)
        };
        let nominal = Device::nominal(&presets::nominal());
        let breakaway_nm = [
            breakaway_nm(nominal.clone())?,
            breakaway_nm(presets::refit())?,
        ];
        Ok(Self {
            low: sine(LOW_NM),
            high: sine(HIGH_NM),
            more_deg: MORE_NM.map(|nm| largest(&positions(&sine(nm)))),
            genuine: [genuine(&nominal, LOW_NM)?, genuine(&nominal, HIGH_NM)?],
            recorded: recorded.and_then(|recording| recording.runs.first().map(aligned)),
            breakaway_nm,
        })
    }

    /// Rows of the breakaway torque and of the peak-to-peak positions.
    pub fn rows(&self) -> Vec<Row> {
        let [breakaway_nm, refit_nm] = self.breakaway_nm;
        let [lowest, highest] = range(&positions(&self.high));
        let [_, settled] = range(&positions(&self.low)[self.low.len() / 6 * 5..]);
        let settled_s = settling_s(&self.high);
        let genuine_deg = self.genuine.each_ref().map(|points| {
            let [lowest, highest] = range(&points[points.len() / 2..]);
            0.5 * (highest - lowest)
        });
        let mut rows = vec![
            Row::new(
                "breakaway, 1 mN m",
                Some(1e3 * BREAKAWAY_NM),
                1e3 * breakaway_nm,
                "mN m",
            )
            .within_share(BREAKAWAY_BAR_SHARE, 1e3 * BREAKAWAY_NM),
            Row::new(
                "breakaway, refitted paddle",
                Some(1e3 * BREAKAWAY_NM),
                1e3 * refit_nm,
                "mN m",
            )
            .remarked(OTHER_DAY),
            Row::new(
                "lab model, 1.01 mN m, settled peak",
                Some(13.0),
                settled,
                "°",
            )
            .within_share(PEAK_BAR_SHARE, 13.0)
            .remarked(INERT),
            Row::new("lab model, 1.1 mN m, highest", Some(49.5), highest, "°")
                .within_share(PEAK_BAR_SHARE, 49.5)
                .remarked(INERT),
            Row::new("lab model, 1.1 mN m, lowest", Some(-51.8), lowest, "°")
                .within_share(PEAK_BAR_SHARE, -51.8)
                .remarked(INERT),
            Row::new("lab model, 1.1 mN m, drifts to", Some(45.0), highest, "°").remarked(NOT_READ),
            Row::new(
                "lab model, 1.1 mN m, settles after",
                Some(12.0),
                settled_s,
                "s",
            )
            .within_share(PEAK_BAR_SHARE, 12.0),
            Row::new(
                "lab model, 2 mN m, largest angle",
                Some(100.0),
                self.more_deg[0],
                "°",
            )
            .between(order_of(100.0)),
            Row::new(
                "lab model, 5 mN m, largest angle",
                Some(1000.0),
                self.more_deg[1],
                "°",
            )
            .between(order_of(1000.0)),
            Row::new(
                "true dry friction, 1.01 mN m, half swing",
                None,
                genuine_deg[0],
                "°",
            )
            .remarked(GENUINE),
            Row::new(
                "true dry friction, 1.1 mN m, half swing",
                None,
                genuine_deg[1],
                "°",
            )
            .within_share(PEAK_BAR_SHARE, 0.9)
            .remarked(GENUINE),
        ];
        if let Some(recorded) = &self.recorded {
            let [lowest, highest] = range(recorded);
            rows.push(Row::new(
                "recorded paddle, 1.1 mN m, lowest",
                None,
                lowest,
                "°",
            ));
            rows.push(Row::new(
                "recorded paddle, 1.1 mN m, highest",
                None,
                highest,
                "°",
            ));
        }
        rows
    }

    /// Figures 3 and 4.
    pub fn figures(&self) -> [(&'static str, Figure); 2] {
        let of = |samples: &[LabSample], value: fn(&LabSample) -> f64| -> Points {
            let shown = samples.iter().take_while(|s| s.time_s <= SHOWN_S);
            shown.map(|s| (s.time_s, value(s))).collect()
        };
        let panel = |y_label: &str, lines: Vec<(&str, Ink, Points)>| Panel {
            y_label: y_label.into(),
            lines: lines
                .into_iter()
                .map(|(label, ink, points)| Line {
                    label: label.into(),
                    ink,
                    points,
                })
                .collect(),
            ..Panel::default()
        };
        let alone = |y_label: &str, value| {
            panel(
                y_label,
                vec![("lab model", Ink::Model, of(&self.low, value))],
            )
        };
        let acceleration: Vec<_> = self
            .low
            .windows(2)
            .take_while(|pair| pair[0].time_s <= SHOWN_S)
            .map(|pair| {
                let gained_rad_s = pair[1].velocity_rad_s - pair[0].velocity_rad_s;
                (pair[0].time_s, (gained_rad_s / STEP_S).to_degrees())
            })
            .collect();
        let figure_3 = Figure {
            title: "Figure 3: the lab's model under a torque sine of 1.01 mN m, 1 Hz".into(),
            x_label: "time, s".into(),
            panels: vec![
                alone("position, degrees", |s| s.position_rad.to_degrees()),
                alone("velocity, °/s", |s| s.velocity_rad_s.to_degrees()),
                panel(
                    "acceleration, °/s²",
                    vec![("lab model", Ink::Model, acceleration)],
                ),
            ],
            ..Figure::default()
        };
        let mut compared = vec![(
            "lab's model",
            Ink::Model,
            of(&self.high, |s| s.position_rad.to_degrees()),
        )];
        compared.extend(self.recorded.as_ref().map(|recorded| {
            let shown = recorded.iter().take_while(|p| p.0 <= SHOWN_S);
            ("recorded", Ink::Measured, shown.copied().collect())
        }));
        let shown = self.genuine[1].iter().take_while(|p| p.0 <= SHOWN_S);
        compared.push((
            "friction that acts",
            Ink::Other(1),
            shown.copied().collect(),
        ));
        let figure_4 = Figure {
            title: "Figure 4: a torque sine of 1.1 mN m, 1 Hz".into(),
            x_label: "time, s".into(),
            panels: vec![panel("position, degrees", compared)],
            ..Figure::default()
        };
        [("figure-3.svg", figure_3), ("figure-4.svg", figure_4)]
    }
}

/// A bar from `size` to ten times `size`.
fn order_of(size: f64) -> [f64; 2] {
    [size, 10.0 * size]
}

fn positions(samples: &[LabSample]) -> Points {
    let points = samples.iter();
    points
        .map(|s| (s.time_s, s.position_rad.to_degrees()))
        .collect()
}

fn range(points: &[(f64, f64)]) -> [f64; 2] {
    let ordinates = || points.iter().map(|p| p.1);
    [
        ordinates().fold(f64::INFINITY, f64::min),
        ordinates().fold(f64::NEG_INFINITY, f64::max),
    ]
}

fn largest(points: &[(f64, f64)]) -> f64 {
    points.iter().map(|p| p.1.abs()).fold(0.0, f64::max)
}

/// Time of the first peak after which all peaks are within [`SETTLED_SHARE`] of the last peak.
fn settling_s(samples: &[LabSample]) -> f64 {
    let peaks: Vec<_> = samples
        .windows(3)
        .filter(|w| w[1].position_rad > w[0].position_rad && w[1].position_rad >= w[2].position_rad)
        .map(|w| (w[1].time_s, w[1].position_rad))
        .collect();
    let Some(&(_, last)) = peaks.last() else {
        return f64::INFINITY;
    };
    let settled = peaks.iter().rev();
    settled
        .take_while(|(_, peak)| (peak / last - 1.0).abs() <= SETTLED_SHARE)
        .last()
        .map_or(f64::INFINITY, |(time_s, _)| *time_s)
}

/// Torque of a ramp at which the paddle has moved by 0.5°, N m at the motor.
fn breakaway_nm(device: Device) -> Result<f64, Failure> {
    let ramp = Excitation {
        shape: Shape::Ramp,
        duration_s: RAMP_S,
        ..Excitation::step(RAMP_NM)
    };
    let setup = LoopSetup::ideal(device, Settings::default());
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Torque)?;
    Experiment::torque(ramp, f64::from(RAMP_S)).run(&mut closed_loop)?;
    let breakaway_nm = closed_loop.controller().breakaway();
    Ok(breakaway_nm.map_or(f64::INFINITY, f64::from))
}

/// Simulates a sine on a device with effective dry friction.
fn genuine(device: &Device, amplitude_nm: f64) -> Result<Points, Failure> {
    let sine = Excitation::sine(amplitude_nm as f32, FREQUENCY_HZ as f32);
    let setup = LoopSetup::ideal(device.clone(), Settings::default());
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Torque)?;
    let trace = Experiment::torque(sine, SECONDS).run(&mut closed_loop)?;
    let points = trace.time_s.iter().zip(&trace.position_rad);
    Ok(points.map(|(t, x)| (*t, x.to_degrees())).collect())
}

/// A recorded run with its time origin at the start of a torque period. The phase of the fundamental gives the origin.
fn aligned(run: &Run) -> Points {
    let products = run.time.iter().zip(&run.input).map(|(t, input)| {
        let (sin, cos) = (TAU * FREQUENCY_HZ * t).sin_cos();
        [input * cos, input * sin]
    });
    let [cos, sin] = products.fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
    // The torque is sin(2 π f t + phase) times the amplitude.
    let phase = cos.atan2(sin).rem_euclid(TAU);
    let begins_s = (TAU - phase) / (TAU * FREQUENCY_HZ);
    let points = run.time.iter().zip(&run.position);
    points
        .map(|(t, x)| (t - begins_s, x.to_degrees()))
        .filter(|(t, _)| *t >= 0.0)
        .collect()
}
