//! Table 1 of the report and the gains of Ziegler and Nichols: figures 7, 8 and 9.

use super::apparatus::{Apparatus, Response, Step, TARGET_DEG};
use super::row::Row;
use crate::failure::Failure;
use crate::plot::{Band, Figure, Ink, Line, Panel, step_response};
use haptic_paddle::settings::Sensor;
use recording::{Recording, Run};

/// The reference value of a row.
#[derive(Clone, Copy)]
enum Bar {
    /// The number in the report.
    Report,
    /// The result of an independent simulation of the refitted paddle.
    Refit(f64),
    /// No reference, and the reason.
    None(&'static str),
}

/// A row of the table: overshoot in degrees, rise and settling time in ms. A time that is never reached is infinite.
struct Setting {
    name: &'static str,
    step: Step,
    report: [f64; 3],
    bars: [Bar; 3],
}

const fn step(sensor: Sensor, gains: [f32; 3], start_deg: f64) -> Step {
    Step {
        sensor,
        gains,
        start_deg,
        seconds: 1.0,
    }
}

/// Integral gain of the report: 0.0001 per sample of 350 µs.
const KI: f32 = 0.0001 / 350e-6;
const NEVER: f64 = f64::INFINITY;

const ARTEFACT: Bar =
    Bar::None("9.85 ms is an artefact of the log: the paddle creeps into the band and rests there");
const KNIFE_EDGE: Bar = Bar::None(
    "it hangs on a hundredth of a degree: the paddle comes to rest about as far off as the band is wide",
);
const REFITTED: &str =
    "the bar is what an independent simulation of the same refitted paddle gives, not the report";

/// Each step starts at the angle at which its log starts, or at 0 if there is no log.
const SETTINGS: [Setting; 9] = [
    Setting {
        name: "Hall 1",
        step: step(Sensor::Hall, [0.01, 0.0, 0.0003], 0.582),
        report: [0.0, NEVER, NEVER],
        bars: [Bar::Report; 3],
    },
    Setting {
        name: "Hall 2",
        step: step(Sensor::Hall, [0.05, 0.0, 0.0003], 0.183),
        report: [4.42, 22.05, 135.80],
        bars: [Bar::Refit(4.55), Bar::Refit(23.8), KNIFE_EDGE],
    },
    Setting {
        name: "Hall 3",
        step: step(Sensor::Hall, [0.05, 0.0, 0.0008], 0.0),
        report: [0.52, 36.05, 66.85],
        bars: [Bar::Refit(0.47), Bar::Refit(37.5), Bar::Refit(69.0)],
    },
    Setting {
        name: "Hall 4",
        step: step(Sensor::Hall, [0.05, KI, 0.0008], 0.0),
        report: [1.59, 31.15, 296.45],
        bars: [Bar::Refit(1.51), Bar::Refit(32.2), Bar::Refit(317.0)],
    },
    Setting {
        name: "encoder 1",
        step: step(Sensor::Encoder, [0.01, 0.0, 0.0003], -0.228),
        report: [0.0, NEVER, 9.85],
        bars: [Bar::Report, Bar::Report, ARTEFACT],
    },
    Setting {
        name: "encoder 2",
        step: step(Sensor::Encoder, [0.05, 0.0, 0.0003], -0.192),
        report: [4.69, 25.90, NEVER],
        bars: [Bar::Report, Bar::Report, KNIFE_EDGE],
    },
    Setting {
        name: "encoder 3",
        step: step(Sensor::Encoder, [0.05, 0.0, 0.0008], 0.336),
        report: [0.65, 40.95, 75.60],
        bars: [Bar::Report; 3],
    },
    Setting {
        name: "encoder 4",
        step: step(Sensor::Encoder, [0.05, KI, 0.0008], 0.0),
        report: [1.82, 35.00, 325.50],
        bars: [Bar::Report; 3],
    },
    Setting {
        name: "Ziegler-Nichols",
        step: step(Sensor::Hall, [0.03, 0.692, 0.000325], -1.831),
        report: [10.2, 21.0, 341.25],
        bars: [Bar::Refit(9.0), Bar::Refit(28.0), Bar::Refit(321.0)],
    },
];

const HALL: std::ops::Range<usize> = 0..4;
const ENCODER: std::ops::Range<usize> = 4..8;
const ENCODER_1: usize = 4;
const ZIEGLER_NICHOLS: usize = 8;

/// Step from 0° with encoder 2, for the steady-state error of its log, degrees.
const FROM_ZERO: Step = step(Sensor::Encoder, [0.05, 0.0, 0.0003], 0.0);
const REST_ERROR_DEG: f64 = 0.208;
const REST_ERROR_BAR_DEG: f64 = 0.03;

const OVERSHOOT_BAR_DEG: f64 = 0.2;
const TIME_BAR_SHARE: f64 = 0.1;
/// Half width of the settling band, degrees.
const BAND_DEG: f64 = 0.2;

/// Simulated steps of the table.
pub struct Gains {
    responses: Vec<Response>,
    from_zero: Response,
}

impl Gains {
    /// Simulates the steps on `apparatus`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the controller refuses a step or stops.
    pub fn run(apparatus: &Apparatus) -> Result<Self, Failure> {
        let responses = SETTINGS.iter().map(|setting| apparatus.step(&setting.step));
        Ok(Self {
            responses: responses.collect::<Result<_, _>>()?,
            from_zero: apparatus.step(&FROM_ZERO)?,
        })
    }

    /// Rows with the overshoot, rise and settling time of each step, then the steady-state errors.
    pub fn rows(&self) -> Vec<Row> {
        let steps = SETTINGS.iter().zip(&self.responses);
        let rest_error =
            |response: &Response| f64::from(response.metrics.steady_state_error_rad.to_degrees());
        let in_band = rest_error(&self.responses[ENCODER_1]);
        let from_zero = rest_error(&self.from_zero);
        steps
            .flat_map(|(setting, response)| rows(setting, response))
            .chain([
                Row::new("encoder 1, rest error", None, in_band, "°").within(BAND_DEG, 0.0),
                Row::new(
                    "encoder 2 from 0°, rest error",
                    Some(REST_ERROR_DEG),
                    from_zero,
                    "°",
                )
                .within(REST_ERROR_BAR_DEG, REST_ERROR_DEG),
            ])
            .collect()
    }

    /// Figures 7, 8 and 9. `recorded` contains the lab's steps with the encoder.
    pub fn figures(&self, recorded: Option<&Recording>) -> [(&'static str, Figure); 3] {
        let runs = recorded.iter().flat_map(|recording| &recording.runs);
        let recorded: Vec<_> = runs.filter_map(since_switched_on).collect();
        let compared = |title: &str, which: std::ops::Range<usize>, recorded: &[Line]| {
            let steps = SETTINGS[which.clone()].iter().zip(&self.responses[which]);
            Figure {
                title: title.into(),
                x_label: "time, ms".into(),
                panels: vec![Panel {
                    y_label: "position, degrees".into(),
                    band: Some(Band {
                        from: TARGET_DEG - BAND_DEG,
                        to: TARGET_DEG + BAND_DEG,
                    }),
                    lines: recorded
                        .iter()
                        .cloned()
                        .chain(steps.enumerate().map(|(place, (setting, response))| Line {
                            label: setting.label(),
                            ink: Ink::Other(place),
                            points: response.points(SHOWN_S),
                        }))
                        .collect(),
                    ..Panel::default()
                }],
                ..Figure::default()
            }
        };
        let last = &self.responses[ZIEGLER_NICHOLS];
        let ziegler_nichols = Figure {
            title: "Figure 9: gains by Ziegler and Nichols, Hall sensor".into(),
            x_label: "time, ms".into(),
            panels: vec![step_response(
                last.points(SHOWN_S),
                TARGET_DEG,
                BAND_DEG,
                &last.metrics,
            )],
            ..Figure::default()
        };
        [
            (
                "figure-7.svg",
                compared("Figure 7: step by the Hall sensor", HALL, &[]),
            ),
            (
                "figure-8.svg",
                compared("Figure 8: step by the encoder", ENCODER, &recorded),
            ),
            ("figure-9.svg", ziegler_nichols),
        ]
    }
}

/// Time axis of a step in the figures, s.
const SHOWN_S: f64 = 0.5;

/// The measured position of a run from the time at which its setpoint changes. The effect of the board's filter was removed
/// from the recordings.
fn since_switched_on(run: &Run) -> Option<Line> {
    let setpoint = run.setpoint.as_ref()?;
    let jump = setpoint.windows(2).position(|pair| pair[0] != pair[1])? + 1;
    let began_s = run.time[jump];
    let samples = run.time[jump..].iter().zip(&run.position[jump..]);
    Some(Line {
        label: format!("recorded {}", run.file.trim_end_matches(".csv")),
        ink: Ink::Measured,
        points: samples
            .map(|(t, x)| (1e3 * (t - began_s), x.to_degrees()))
            .take_while(|(ms, _)| *ms <= 1e3 * SHOWN_S)
            .collect(),
    })
}

fn rows(setting: &Setting, response: &Response) -> [Row; 3] {
    let ms = |seconds: Option<f32>| seconds.map_or(NEVER, |s| 1e3 * f64::from(s));
    let metrics = &response.metrics;
    let overshoot_deg = f64::from(metrics.overshoot_rad.to_degrees());
    let row = |place: usize, quantity: &str, ours: f64, unit: &'static str| {
        let name = format!("{}, {quantity}", setting.name);
        let row = Row::new(name, Some(setting.report[place]), ours, unit);
        let about = |row: Row, centre: f64| match place {
            0 => row.within(OVERSHOOT_BAR_DEG, centre),
            _ => row.within_share(TIME_BAR_SHARE, centre),
        };
        match setting.bars[place] {
            Bar::Report => about(row, setting.report[place]),
            Bar::Refit(centre) => about(row, centre).remarked(REFITTED),
            Bar::None(why) => row.remarked(why),
        }
    };
    [
        row(0, "overshoot", overshoot_deg, "°"),
        row(1, "rise", ms(metrics.rise_s), "ms"),
        row(2, "settling", ms(metrics.settling_s), "ms"),
    ]
}

impl Setting {
    /// The gains as text.
    fn label(&self) -> String {
        let [kp, ki, kd] = self.step.gains;
        match ki > 0.0 {
            true => format!("{kp} {ki:.3} {kd}"),
            false => format!("{kp} 0 {kd}"),
        }
    }
}
