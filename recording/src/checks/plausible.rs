//! Unit mistakes: numbers that no device could show together, however wrong its model is.
//!
//! Only clear cases are refused: a false alarm is worse than a miss. On five real recordings with the nominal models of
//! their authors the acceleration ratio is 0.01 to 0.3; with degrees for radians it is 57 times that.

use std::ops::Range;

use crate::error::{Error, Fault};
use crate::statistics::{extremes, is_constant, median, quantile};
use crate::{Drive, Model, Recording, Run};

/// A window with fewer samples than this cannot be judged at all, so the time is in another unit.
const SAMPLES_PER_HORIZON: f64 = 3.0;
/// The position spans this many times the stated travel.
const TRAVELS: f64 = 10.0;
/// The median input is this many times the stated limit.
const LIMITS: f64 = 20.0;
/// This limit for the input of a loop, which may be logged before it is limited and swing far beyond.
const LOOP_LIMITS: f64 = 200.0;
/// The median acceleration is this many times what twice the model's torques together give.
const ACCELERATIONS: f64 = 10.0;
/// The same for an axis with gravity that spans more than [`TURN_RAD`]: a pendulum does not spin by accident.
const PENDULUM_ACCELERATIONS: f64 = 1.5;
/// One turn, rad.
const TURN_RAD: f64 = std::f64::consts::TAU;
/// In one horizon the model's net torque would carry it this many times the span of the position.
const SPANS: f64 = 1000.0;
/// Places at which a run is looked at.
const PLACES: usize = 1000;
/// Share of places at which the position must move for the motion to be judged.
const MOVING_SHARE: f64 = 0.25;
/// Time constants after which a lag has settled.
const LAGS: f64 = 3.0;
/// Standard deviations of noise that pass for no motion.
const NOISE_DEVIATIONS: f64 = 5.0;

/// Judges the units of one run.
///
/// # Errors
/// [`Fault::TimeUnit`], [`Fault::PositionUnit`], [`Fault::InputUnit`] or [`Fault::ModelUnit`].
pub(crate) fn run(run: &Run, recording: &Recording) -> Result<(), Error> {
    let period_s = median(run.time.windows(2).map(|pair| pair[1] - pair[0]).collect());
    if period_s * SAMPLES_PER_HORIZON > recording.horizon {
        let horizon = recording.horizon;
        return Err(Error::new(Fault::TimeUnit { period_s, horizon }));
    }
    let model = &recording.model_of(run);
    let span = quantile(run.position.clone(), 0.95) - quantile(run.position.clone(), 0.05);
    if let Some([low, high]) = model.travel
        && span > TRAVELS * (high - low)
    {
        let why = format!("it spans {span:.4} where `travel` spans {:.4}", high - low);
        return Err(Error::new(Fault::PositionUnit { why }));
    }
    if let Some(limit) = model.input_limit {
        let typical = median(
            run.input
                .iter()
                .map(|input| input.abs())
                .filter(|input| *input > 0.0)
                .collect(),
        );
        let limits = match run.drive {
            Drive::OpenLoop => LIMITS,
            Drive::ClosedLoop => LOOP_LIMITS,
        };
        if typical > limits * limit {
            return Err(Error::new(Fault::InputUnit { typical, limit }));
        }
    }
    let Some(motion) = motion(run, recording) else {
        return Ok(());
    };
    let pendulum = model.gravity != 0.0 && span > TURN_RAD;
    if motion.accelerations
        > if pendulum {
            PENDULUM_ACCELERATIONS
        } else {
            ACCELERATIONS
        }
    {
        let why = format!(
            "it accelerates {:.1} times as much as twice all torques of [model] together could",
            motion.accelerations
        );
        return Err(Error::new(Fault::PositionUnit { why }));
    }
    let spans = motion.carry / span;
    if spans > SPANS {
        return Err(Error::new(Fault::ModelUnit { spans }));
    }
    Ok(())
}

/// How the motion compares with the model's torques, as medians over the places where the position moves.
struct Motion {
    /// Measured acceleration over the most that the model can give.
    accelerations: f64,
    /// How far the net torque would carry the model in one horizon.
    carry: f64,
}

/// `None` if the input is constant, so that the motion came from elsewhere, or the position hardly moves.
fn motion(run: &Run, recording: &Recording) -> Option<Motion> {
    if is_constant(&run.input) {
        return None;
    }
    let sensor = recording.sensor("position");
    let blur = sensor.resolution + NOISE_DEVIATIONS * sensor.noise;
    let reach_s = recording.horizon / 4.0;
    let step = (run.len() / PLACES).max(1);
    let places: Vec<_> = (0..run.len())
        .step_by(step)
        .filter_map(|k| Place::around(k, reach_s, run))
        .collect();
    let moving: Vec<_> = places
        .iter()
        .filter(|place| place.moves(run) > 2.0 * blur)
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "counts are small")]
    let share = moving.len() as f64 / places.len().max(1) as f64;
    if share < MOVING_SHARE {
        return None;
    }
    let (low, high) = extremes(&run.input);
    let model = &recording.model_of(run);
    let drive = torque(model, low).max(torque(model, high));
    let accelerations = moving
        .iter()
        .map(|place| place.accelerations(run, recording, drive, blur))
        .collect();
    let carry = moving
        .iter()
        .map(|place| place.carry(run, recording))
        .collect();
    Some(Motion {
        accelerations: median(accelerations),
        carry: median(carry),
    })
}

/// Three samples, about equally far apart in time.
struct Place {
    before: usize,
    at: usize,
    after: usize,
}

impl Place {
    fn around(at: usize, reach_s: f64, run: &Run) -> Option<Self> {
        let time = run.time[at];
        let before = run.time.partition_point(|t| *t < time - reach_s);
        let after = run.time.partition_point(|t| *t < time + reach_s);
        (time - reach_s >= run.time[0] && before < at && after > at && after < run.len())
            .then_some(Self { before, at, after })
    }

    fn samples(&self) -> Range<usize> {
        self.before..self.after + 1
    }

    fn moves(&self, run: &Run) -> f64 {
        let (low, high) = extremes(&run.position[self.samples()]);
        high - low
    }

    fn slopes(&self, run: &Run) -> [f64; 2] {
        let slope =
            |a: usize, b: usize| (run.position[b] - run.position[a]) / (run.time[b] - run.time[a]);
        [slope(self.before, self.at), slope(self.at, self.after)]
    }

    /// Measured acceleration over the most that the model can give, if no input is stronger than `drive`.
    ///
    /// The second divided difference is a mean of the acceleration, so it cannot exceed the largest one. Drag is no
    /// torque of its own here: it is at most what the others spent on the speed, so it doubles them.
    fn accelerations(&self, run: &Run, recording: &Recording, drive: f64, blur: f64) -> f64 {
        let [first, second] = self.slopes(run);
        let half_s = (run.time[self.after] - run.time[self.before]) / 2.0;
        let measured = ((second - first).abs() / half_s - 4.0 * blur / (half_s * half_s)).max(0.0);
        let possible =
            2.0 * (drive + self.holding(run, recording)) / recording.model_of(run).inertia;
        if measured > 0.0 {
            measured / possible
        } else {
            0.0
        }
    }

    /// How far the torque that is left of the input would carry the model in one horizon.
    fn carry(&self, run: &Run, recording: &Recording) -> f64 {
        let model = &recording.model_of(run);
        let velocity = self
            .slopes(run)
            .into_iter()
            .map(f64::abs)
            .fold(0.0, f64::max);
        let resisting = self.holding(run, recording) + model.viscous.abs() * velocity;
        let net = (self.drive(run, recording) - resisting).max(0.0);
        0.5 * net / model.inertia * recording.horizon.powi(2)
    }

    /// Least size of the torque from the input around here; 0 where its sign changes.
    fn drive(&self, run: &Run, recording: &Recording) -> f64 {
        let model = &recording.model_of(run);
        let since = run.time[self.before] - model.delay - LAGS * model.lag;
        let first = run.time.partition_point(|t| *t < since).saturating_sub(1);
        let (low, high) = extremes(&run.input[first..=self.after]);
        let one_sided = low > 0.0 || high < 0.0;
        if one_sided {
            torque(model, low).min(torque(model, high))
        } else {
            0.0
        }
    }

    /// The most that friction, gravity, spring, offset and stops can come to here.
    fn holding(&self, run: &Run, recording: &Recording) -> f64 {
        let model = &recording.model_of(run);
        let (low, high) = extremes(&run.position[self.samples()]);
        let spring = (low - model.stiffness_zero)
            .abs()
            .max((high - model.stiffness_zero).abs());
        let stop = model.travel.map_or(0.0, |[lower, upper]| {
            (lower - low).max(high - upper).max(0.0)
        });
        let steady = model.coulomb + model.gravity.abs() + model.offset.abs();
        steady + model.stiffness.abs() * spring + model.stop_stiffness * stop
    }
}

/// Size of the joint torque of a steady `input`.
fn torque(model: &Model, input: f64) -> f64 {
    let limit = model.input_limit.unwrap_or(f64::INFINITY);
    (model.ratio * input.clamp(-limit, limit)).abs()
}
