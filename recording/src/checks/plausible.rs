//! Finds wrong units: combinations of numbers that no device could have, even with a badly wrong model.
//!
//! Only clear cases are refused, because a false alarm is worse than a missed error. For five real recordings with their
//! authors' nominal models, the acceleration ratio is 0.01 to 0.3. With degrees instead of radians it is 57 times as large.

use std::ops::Range;

use crate::error::{Error, Fault};
use crate::statistics::{extremes, is_constant, median, quantile};
use crate::{Drive, Model, Recording, Run};

/// Fewest samples of a prediction window. With fewer, the time must be in another unit.
const SAMPLES_PER_HORIZON: f64 = 3.0;
/// Least span of the position, over the stated travel, that is refused.
const TRAVELS: f64 = 10.0;
/// Least median of the input, over the stated limit, that is refused.
const LIMITS: f64 = 20.0;
/// The same for a closed loop. Its input may be logged before the limit and exceed it by far.
const LOOP_LIMITS: f64 = 200.0;
/// Least median acceleration, over twice the model's torques divided by its inertia, that is refused.
const ACCELERATIONS: f64 = 10.0;
/// The same for an axis with gravity that moves by more than [`TURN_RAD`]. A pendulum does not rotate unintentionally.
const PENDULUM_ACCELERATIONS: f64 = 1.5;
/// One turn, rad.
const TURN_RAD: f64 = std::f64::consts::TAU;
/// Least distance that the model's net torque would move it in one horizon, over the span of the position, that is refused.
const SPANS: f64 = 1000.0;
/// Number of positions in a run that are examined.
const PLACES: usize = 1000;
/// Least share of them at which the position must move.
const MOVING_SHARE: f64 = 0.25;
/// Time after which a lag has settled, in time constants.
const LAGS: f64 = 3.0;
/// Motion below this number of standard deviations of the noise counts as no motion.
const NOISE_DEVIATIONS: f64 = 5.0;

/// Checks the units of one run.
///
/// # Errors
///
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

/// The motion compared with the model's torques: medians over the examined positions with motion.
struct Motion {
    /// Measured acceleration over the largest one that the model can have.
    accelerations: f64,
    /// Distance by which the net torque would move the model in one horizon.
    carry: f64,
}

/// Compares the motion with the model. Returns `None` if the input is constant, so that something else caused the motion, or
/// if the position hardly moves.
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

/// Three samples at about equal distances in time.
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

    /// Measured acceleration over the largest one that the model can have with an input torque of at most `drive`.
    ///
    /// The second divided difference is a mean of the acceleration, so it cannot exceed the largest one. Drag is not counted
    /// as a separate torque. It is at most as large as the torque that caused the speed, so the other torques are doubled.
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

    /// Distance by which the input torque minus the resisting torques would move the model in one horizon.
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

    /// Smallest magnitude of the input torque around these samples. 0 if its sign changes.
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

    /// Largest sum of friction, gravity, spring, offset and stops at these samples.
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

/// Magnitude of the joint torque for a constant `input`.
fn torque(model: &Model, input: f64) -> f64 {
    let limit = model.input_limit.unwrap_or(f64::INFINITY);
    (model.ratio * input.clamp(-limit, limit)).abs()
}
