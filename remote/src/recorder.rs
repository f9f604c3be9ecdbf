//! Combines runs into a recording.

use haptic_paddle::controller::Mode;
use haptic_paddle::sensing::hall::HallCurve;
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::experiment::{encoder_sensor, other_column, pid};
use link::Channel;
use recording::{Drive, Model, Recording, Run, Tolerance};

use crate::take::TICK_HZ;
use crate::{Row, Taken};

/// Control periods per run of the position loop.
const POSITION_DIVIDER: f64 = 2.0;
/// Converter count around which the resolution of the Hall sensor is computed.
const MIDDLE_ADC: u16 = 2034;

/// Common data of all runs of a recording.
#[derive(Clone, Debug)]
pub struct Session {
    /// A title, for display.
    pub title: String,
    /// Length of a prediction window, s.
    pub horizon_s: f64,
    /// The nominal model of the mechanics. The effect of the firmware's current loop is computed from the settings.
    pub model: Model,
    /// Tolerances of its numbers.
    pub tolerance: Tolerance,
    /// Settings of the board.
    pub settings: Settings,
}

/// A recording to which runs are added.
#[derive(Clone, Debug)]
pub struct Recorder {
    session: Session,
    recording: Recording,
    /// Control period of the first row of the first run.
    begun: Option<u32>,
}

impl Recorder {
    /// A recording without runs.
    ///
    /// A commanded torque acts one control period later, when the timer loads the duty. The current then follows the
    /// feed-forward voltage with the time constant of the winding, inductance over resistance. Both delays are part of the
    /// nominal model.
    pub fn new(session: Session) -> Self {
        let settings = &session.settings;
        let model = Model {
            ratio: settings.mechanism.ratio.into(),
            delay: session.model.delay + 1.0 / TICK_HZ,
            lag: session.model.lag
                + f64::from(settings.motor.inductance_h / settings.motor.resistance_ohm),
            ..session.model
        };
        let mut recording = Recording::new(session.title.clone(), session.horizon_s, model);
        recording.tolerance = session.tolerance.clone();
        let other = match settings.estimate.sensor {
            Sensor::Encoder => {
                recording
                    .sensors
                    .insert("position".into(), encoder_sensor(settings));
                hall_sensor(settings, 0.0)
            }
            Sensor::Hall => {
                recording
                    .sensors
                    .insert("position".into(), hall_sensor(settings, 0.0));
                encoder_sensor(settings)
            }
        };
        recording
            .sensors
            .insert(other_column(settings.estimate.sensor).into(), other);
        Self {
            session,
            recording,
            begun: None,
        }
    }

    /// Adds the run of an experiment. Times continue from run to run by the board's clock, so that slow changes over the
    /// session remain visible. The noise of the Hall sensor is estimated from the rows before the excitation.
    pub fn add(&mut self, taken: &Taken) {
        let settings = &self.session.settings;
        let rows = &taken.rows;
        let closed = taken.plan.mode == Mode::Position;
        let drive = if closed {
            Drive::ClosedLoop
        } else {
            Drive::OpenLoop
        };
        let column = |channel: Channel| -> Vec<f64> {
            rows.iter()
                .map(|row| f64::from(row.value(channel)))
                .collect()
        };
        let first = rows.first().map_or(0, |row| row.period);
        let begun = *self.begun.get_or_insert(first);
        // A control period is a whole number of nanoseconds.
        const PER_S: f64 = 1e9;
        let time = rows
            .iter()
            .map(|row| {
                let since = f64::from(row.period.wrapping_sub(begun));
                (since / TICK_HZ * PER_S).round() / PER_S
            })
            .collect();
        let (position, other) = match settings.estimate.sensor {
            Sensor::Encoder => (Channel::Encoder, Channel::Hall),
            Sensor::Hall => (Channel::Hall, Channel::Encoder),
        };
        let number = self.recording.runs.len() + 1;
        let mut run = Run::new(
            format!(
                "{number:02}-{}-{}.csv",
                taken.plan.mode_name(),
                taken.plan.shape()
            ),
            drive,
            time,
            column(Channel::Torque),
            column(position),
        );
        run.positions
            .insert(other_column(settings.estimate.sensor).into(), column(other));
        run.current = Some(rows.iter().map(|row| row.value(Channel::Current)).collect());
        if closed {
            run.setpoint = Some(column(Channel::Setpoint));
            run.controller = pid(settings, POSITION_DIVIDER / TICK_HZ);
        }
        let before = rows
            .iter()
            .take_while(|row| {
                f64::from(row.period.wrapping_sub(first)) < taken.plan.before_s() * TICK_HZ
            })
            .collect::<Vec<_>>();
        let noise = noise_rad(&before);
        let hall = hall_sensor(settings, noise);
        let name = match settings.estimate.sensor {
            Sensor::Encoder => "position_hall",
            Sensor::Hall => "position",
        };
        if let Some(known) = self.recording.sensors.get_mut(name)
            && known.noise < noise
        {
            *known = hall;
        }
        self.recording.runs.push(run);
    }

    /// The recording so far.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }
}

/// Standard deviation of the Hall sensor between successive rows of a paddle at rest, rad. It excludes slow motion.
fn noise_rad(rows: &[&Row]) -> f64 {
    let steps: Vec<f64> = rows
        .windows(2)
        .map(|pair| f64::from(pair[1].value(Channel::Hall) - pair[0].value(Channel::Hall)))
        .collect();
    if steps.is_empty() {
        return 0.0;
    }
    let mean_square = steps.iter().map(|step| step * step).sum::<f64>() / steps.len() as f64;
    (mean_square / 2.0).sqrt()
}

fn hall_sensor(settings: &Settings, noise_rad: f64) -> recording::Sensor {
    let curve = HallCurve::new(&settings.hall);
    let step = curve.position_rad(MIDDLE_ADC + 1) - curve.position_rad(MIDDLE_ADC);
    recording::Sensor {
        resolution: f64::from(step.abs()),
        noise: noise_rad,
        cutoff_hz: None,
    }
}
