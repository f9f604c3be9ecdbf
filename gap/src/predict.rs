//! Predicts the motion of a device from the recorded input, window by window.

use crate::windows::drive_response::DriveResponse;
use crate::windows::series::{FINE_PERIOD_S, Series, Window, session_start};
use core::f64::consts::TAU;
use host_sim::decay::Decay;
use host_sim::device::Device;
use host_sim::plant::{Follower, Plant, State};
use host_sim::sensing::Reading;
use recording::{Recording, Sensor, low_pass_gain};
use std::collections::BTreeMap;

/// A device with the low-pass of the logged position column.
#[derive(Clone, Debug)]
pub struct Predictor {
    device: Device,
    plant: Plant,
    sensor: Sensor,
    /// True if the sensor has no error.
    reads_as_is: bool,
    /// Additional delay of the input of each run, s. It is 0 for runs beyond the list.
    input_shifts_s: Vec<f64>,
    /// The device of each run that states parameters of its own, by the index of the run.
    device_of_run: BTreeMap<usize, Device>,
}

/// Displacement of the position and of the velocity at every restart, in their standard deviations.
pub type Shift = [f64; 2];

/// Highest angular frequency that averaged samples resolve, rad/s.
const FASTEST_RATE: f64 = 0.25 * TAU / FINE_PERIOD_S;

/// Distance from the restart beyond which the prediction counts as diverged. It is relative to the range of the measured positions plus
/// the travel of a free device under the largest torque. That travel matters for a device that sticks throughout.
const DIVERGED: f64 = 100.0;

fn span(values: &[f64]) -> f64 {
    let extremes = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), extremes);
    (high - low).max(f64::MIN_POSITIVE)
}

/// Least share of the velocity that the reading shows for the velocity to be computed from the slope of the reading.
const LEAST_SHOWN: f64 = 0.5;
/// Number of time constants after which a carried state has decayed to a thousandth, which is below the floor of any gap.
const SETTLED: f64 = 7.0;
/// Largest number of windows that are simulated before a wanted one, and the largest ratio of simulated to wanted windows.
const MOST_LEAD: usize = 8;
const MOST_SIMULATED: f64 = 2.5;

struct Running {
    state: State,
    reading: Reading,
    shown: f64,
    filtered: f64,
    /// Time of the last reading in the run, s.
    read_s: f64,
    /// Delay of the low-pass of the column for a ramp, s.
    logged_s: f64,
    /// Decay of the state of the low-pass of the column.
    fading: Decay,
}

impl Predictor {
    /// Predicts the `position` column of `recording` with `device`.
    pub fn new(mut device: Device, recording: &Recording) -> Self {
        let mechanics = &mut device.mechanics;
        let inertia = mechanics.inertia;
        // The samples do not resolve a stiffer link or stiffer bristles, which would need many more integration steps.
        let link = mechanics.link;
        mechanics.link = link.map(|link| link.bounded(inertia, FASTEST_RATE));
        let level_nm = mechanics.friction.highest_nm();
        let presliding = mechanics.presliding;
        mechanics.presliding = presliding.map(|p| p.bounded(inertia, level_nm, FASTEST_RATE));
        if let Some(drift) = &mut mechanics.friction.drift {
            drift.start_s = session_start(recording);
        }
        let runs = recording.runs.iter().enumerate();
        let runs = runs.filter(|(_, run)| !run.numbers.is_empty());
        let device_of_run = runs.map(|(index, run)| {
            let model_of_run = recording.model_of(run);
            (index, device.with_load(&recording.model, &model_of_run))
        });
        Self {
            device_of_run: device_of_run.collect(),
            ..Self::of(device, recording.sensor("position"))
        }
    }

    fn of(device: Device, sensor: Sensor) -> Self {
        Self {
            plant: Plant::quick(device.mechanics.clone()),
            reads_as_is: device.sensing.is_ideal(),
            device,
            sensor,
            input_shifts_s: Vec::new(),
            device_of_run: BTreeMap::new(),
        }
    }

    /// The predictor with an additional delay of the input of each run, s; negative for an earlier input.
    pub(crate) fn shifted(self, input_shifts_s: Vec<f64>) -> Self {
        Self {
            input_shifts_s,
            ..self
        }
    }

    /// The device with the load of the model of the recording.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The predicted position of each sample, in position units.
    pub fn predict(&self, series: &Series) -> Vec<f64> {
        self.predict_shifted(series, [0.0, 0.0], |_| true)
    }

    /// The predicted positions from displaced restarts, for the wanted windows by index. The positions of other windows are 0.
    pub fn predict_shifted(
        &self,
        series: &Series,
        shift: Shift,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<f64> {
        match self.in_run(series) {
            Some(with_own_load) => with_own_load.through(series, shift, wanted),
            None => self.through(series, shift, wanted),
        }
    }

    /// The predictor with the load of a run, and with effects that restart with the clock of the run. Returns `None` if neither differs.
    fn in_run(&self, series: &Series) -> Option<Self> {
        let device_of_run = self.device_of_run.get(&series.run);
        let mut device = device_of_run.unwrap_or(&self.device).clone();
        let drift = device.mechanics.friction.drift.as_mut();
        let anew = drift.filter(|drift| drift.anew && series.session_offset_s != 0.0);
        if device_of_run.is_none() && anew.is_none() {
            return None;
        }
        if let Some(drift) = anew {
            drift.start_s = series.started_s + series.session_offset_s;
        }
        Some(Self::of(device, self.sensor).shifted(self.input_shifts_s.clone()))
    }

    fn through(&self, series: &Series, shift: Shift, wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let has_carried_state = self.has_carried_state();
        let mut predicted = vec![0.0; series.time.len()];
        let Some(first) = series.windows.first() else {
            return predicted;
        };
        let span = span(&series.position);
        let start_s = first.restart.time_s;
        let x = self.device.sensing.inverse(first.restart.value);
        let mut running = Running {
            state: self.plant.state(start_s + series.session_offset_s, x, 0.0),
            reading: Reading::at_rest(&self.device.sensing, x),
            shown: first.restart.value,
            filtered: first.restart.value,
            read_s: start_s,
            logged_s: series.logged_lag_s(self.sensor.cutoff_hz),
            fading: Decay::default(),
        };
        let mut follower = Follower::new(&self.plant, series.step_s());
        let low_passes = [
            self.device.sensing.lag_s > 0.0,
            self.device.sensing.further_lag_s > 0.0,
            self.sensor.cutoff_hz.is_some(),
        ];
        let low_passes = low_passes
            .into_iter()
            .filter(|is_present| *is_present)
            .count();
        let mut drive = self.device.drive.clone();
        drive.delay_s += self.input_shifts_s.get(series.run).unwrap_or(&0.0);
        let response = DriveResponse::new(&drive, series);
        let simulated = self.simulated(series, wanted);
        for (index, window) in series.windows.iter().enumerate() {
            if !simulated[index] {
                continue;
            }
            let restart_s = window.restart.time_s;
            let follows = has_carried_state && (index == 0 || simulated[index - 1]);
            let samples = window.samples.clone();
            response.in_window(index, |profile| {
                if follows {
                    let mut seen = [0.0];
                    follower.follow(&mut running.state, &profile.lead, response.gain, &mut seen);
                    self.read(&mut running, series, seen[0], restart_s);
                }
                let x = self.restart(&mut running, series, window, shift, follows);
                let seen = &mut predicted[samples.clone()];
                // Where the sensor characteristic is flat, the position is unknown, so the prediction is constant.
                if self.device.sensing.is_flat(x) {
                    seen.fill(x);
                    return;
                }
                follower.follow(&mut running.state, &profile.steps, response.gain, seen);
                series.averaging.apply(samples.start, seen, low_passes);
            });
            running.read_s = restart_s;
            let window_s = series.time[samples.end - 1] - restart_s;
            let farthest = DIVERGED * (span + self.free_travel(series, window_s));
            for i in samples {
                predicted[i] = self.read(&mut running, series, predicted[i], series.time[i]);
                let distance = (predicted[i] - window.restart.value).abs();
                if distance.is_nan() || distance > farthest {
                    self.end_diverged(&mut running, series, window, &mut predicted[i..]);
                    break;
                }
            }
        }
        predicted
    }

    /// Ends a window in which the prediction diverges: the prediction stays constant, and the carried state is reset to rest.
    fn end_diverged(
        &self,
        running: &mut Running,
        series: &Series,
        window: &Window,
        rest: &mut [f64],
    ) {
        let left = window.samples.end - (series.time.len() - rest.len());
        let here = if rest[0].is_finite() {
            rest[0]
        } else {
            f64::MAX.sqrt()
        };
        rest[..left].fill(here);
        let end_s = series.time[window.samples.end - 1];
        let session_s = end_s + series.session_offset_s;
        let x = self.device.sensing.inverse(window.restart.value);
        running.state = self.plant.state(session_s, x, 0.0);
        running.reading = Reading::at_rest(&self.device.sensing, x);
        running.shown = window.restart.value;
        running.filtered = window.restart.value;
        running.read_s = end_s;
    }

    /// Travel of a free device under the largest torque within a time, in position units.
    fn free_travel(&self, series: &Series, within_s: f64) -> f64 {
        let Device {
            drive, mechanics, ..
        } = &self.device;
        let torque_nm = drive.settled(series.largest_input).abs() + mechanics.gravity.abs();
        0.5 * torque_nm / mechanics.inertia * within_s.powi(2)
    }

    /// True if the device has a state, other than that of the drive, that is carried from window to window.
    fn has_carried_state(&self) -> bool {
        let mechanics = &self.device.mechanics;
        mechanics.link.is_some()
            || mechanics.presliding.is_some()
            || !self.device.sensing.hysteresis.is_none()
            || self.device.sensing.lag_s > 0.0
            || !self.device.sensing.overspeed.is_none()
    }

    /// The windows to simulate for the wanted ones. Some windows before them are included, in which the carried state settles.
    fn simulated(&self, series: &Series, wanted: impl Fn(usize) -> bool) -> Vec<bool> {
        let count = series.windows.len();
        let wanted: Vec<bool> = (0..count).map(wanted).collect();
        let number = |of: &[bool]| of.iter().filter(|simulated| **simulated).count();
        let most = MOST_SIMULATED * number(&wanted) as f64;
        let with = |lead: usize| -> Vec<bool> {
            let ahead = |index: usize| index..count.min(index + lead + 1);
            (0..count)
                .map(|index| wanted[ahead(index)].contains(&true))
                .collect()
        };
        let longest = self.lead(series);
        let mut leads = (1..=longest).rev().map(with);
        let affordable = leads.find(|simulated| number(simulated) as f64 <= most);
        affordable.unwrap_or_else(|| with(longest.min(1)))
    }

    /// Number of windows before a wanted one in which the carried state settles.
    fn lead(&self, series: &Series) -> usize {
        if !self.has_carried_state() {
            return 0;
        }
        let mechanics = &self.device.mechanics;
        let sensing = &self.device.sensing;
        let has_play =
            !sensing.hysteresis.is_none() || mechanics.link.is_some_and(|link| link.play > 0.0);
        if has_play || mechanics.presliding.is_some() || !sensing.overspeed.is_none() {
            // The state of a play, of a bristle or of a counter is known only after some time.
            return MOST_LEAD;
        }
        let ringing_s = mechanics
            .link
            .map_or(0.0, |link| link.memory_s(mechanics.inertia));
        let lags_s = sensing.lag_s + sensing.further_lag_s;
        let windows = (SETTLED * ringing_s.max(lags_s) / series.window_s()).ceil();
        // The rate of change of the sensor lag is known one window after the velocity.
        let speed = usize::from(sensing.lag_s > 0.0);
        (windows as usize + speed).clamp(1, MOST_LEAD)
    }

    /// Sets the state of the device to that of the restart, and returns the position. State variables that the sensor does not show
    /// continue if this window follows the last one.
    fn restart(
        &self,
        running: &mut Running,
        series: &Series,
        window: &Window,
        shift: Shift,
        follows: bool,
    ) -> f64 {
        let fit = &window.restart;
        let sd = |i: usize| window.restart.covariance[i][i].sqrt() * window.restart_noise;
        let value = fit.value + shift[0] * sd(0);
        let slope = fit.slope + shift[1] * sd(1);
        let sensing = &self.device.sensing;
        let session_s = fit.time_s + series.session_offset_s;
        let logged_s = running.logged_s;
        // The low-pass of the column is inverted with the slope of the reading. The slopes are too noisy to invert the lag of the sensor.
        let ([lag, lag_rate, further], lost) = if follows {
            (self.sensor_lag(running), running.reading.lost)
        } else {
            ([0.0; 3], 0.0)
        };
        let lagged = value + logged_s * slope - sensing.jumped(session_s) + lost;
        let behind = lagged + lag;
        let shown_rate = slope + logged_s * fit.curvature;
        let rate = sensing.overspeed.undone(shown_rate) + lag_rate;
        running.shown = value + logged_s * slope;
        running.filtered = value;

        let hysteresis = &sensing.hysteresis;
        let (_, seen_rate) = self.plant.seen(&running.state);
        // The error of the hysteresis is not observable. During motion it reaches its limit.
        let (inside, direction) = if follows {
            (running.reading.behind, seen_rate)
        } else {
            (hysteresis.half_width.copysign(rate), rate)
        };
        let x = sensing.inverse(behind + inside);
        // If the reading shows hardly any of the velocity, its slope gives little information, and none within the play.
        let shown = hysteresis.shown(inside, direction);
        let v = if shown < LEAST_SHOWN {
            seen_rate
        } else {
            rate / (sensing.slope(x) * shown)
        };
        running.reading = Reading {
            followed: behind,
            behind: inside,
            between: lagged + further,
            lagged,
            lost,
        };
        running.state = self.plant.restart(&running.state, session_s, x, v);
        x
    }

    /// The lag of the sensor, its rate of change, and the part of its second low-pass.
    fn sensor_lag(&self, running: &Running) -> [f64; 3] {
        let sensing = &self.device.sensing;
        if sensing.lag_s <= 0.0 {
            return [0.0; 3];
        }
        let (x, v) = self.plant.seen(&running.state);
        let Reading {
            followed,
            between,
            lagged,
            ..
        } = running.reading;
        let [lag, further] = [followed - lagged, between - lagged];
        let follows_at = if sensing.further_lag_s > 0.0 {
            further / sensing.further_lag_s
        } else {
            lag / sensing.lag_s
        };
        [lag, sensing.slope(x) * v - follows_at, further]
    }

    /// The reading of the column for a position at an instant of the run.
    #[inline]
    fn read(&self, running: &mut Running, series: &Series, x: f64, at_s: f64) -> f64 {
        if self.reads_as_is && self.sensor.cutoff_hz.is_none() {
            return x;
        }
        let dt_s = at_s - running.read_s;
        running.read_s = at_s;
        let y = if self.reads_as_is {
            x
        } else {
            let sensing = &self.device.sensing;
            let jumped = sensing.jumped_mean(at_s + series.session_offset_s, series.span_s);
            running.reading.follow(sensing, x, dt_s) + jumped
        };
        running.filtered = self.low_passed(running, series, y, dt_s);
        running.shown = y;
        running.filtered
    }

    /// The output of the low-pass of the column for a reading that changes linearly to `y` within `dt_s`. It is the closed form of the
    /// recursion per sampling period, because averaged samples are several periods apart.
    #[inline]
    fn low_passed(&self, running: &mut Running, series: &Series, y: f64, dt_s: f64) -> f64 {
        let Some(cutoff_hz) = self.sensor.cutoff_hz else {
            return y;
        };
        if dt_s <= 0.0 {
            return running.filtered;
        }
        let behind = running.logged_s * (y - running.shown) / dt_s;
        let deviation = running.filtered - (running.shown - behind);
        let left = || 1.0 - low_pass_gain(Some(cutoff_hz), series.period_s);
        y - behind + deviation * running.fading.over(dt_s, || left().ln() / series.period_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;
    use crate::windows::series;

    #[test]
    fn the_carried_state_settles_in_the_windows_before_a_wanted_one() {
        let recording = made::recording(&[]);
        let series = &series::coarse(&recording, recording.horizon)[0];
        let device = |lag_s| {
            let mut device = Device::nominal(&recording.model);
            device.sensing.lag_s = lag_s;
            Predictor::new(device, &recording)
        };
        let lagging = device(series.window_s() / 20.0);
        let wanted = |window: usize| window % 6 >= 3;
        let some = lagging.predict_shifted(series, [0.0, 0.0], wanted);
        let farthest = |other: &[f64]| {
            let windows = series.windows.iter().enumerate();
            let samples = windows.filter(|(w, _)| wanted(*w));
            let samples = samples.flat_map(|(_, window)| window.samples.clone());
            samples
                .map(|i| (some[i] - other[i]).abs())
                .fold(0.0, f64::max)
        };
        let lag = farthest(&device(0.0).predict(series));
        let unsettled = farthest(&lagging.predict(series));
        assert!(unsettled < 0.02 * lag, "{unsettled} {lag}");
    }

    #[test]
    fn the_hysteresis_of_a_sensor_is_carried_from_window_to_window() {
        for hidden in [
            "sensor_hysteresis:width=0.03",
            "sensor_hysteresis:width=0.03,reach=0.045",
        ] {
            let recording = made::recording(&[hidden]);
            let problem = made::problem(&recording);
            let gap = |known: &[&str]| {
                let terms = known.iter().map(|effect| made::written(effect)).collect();
                let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
                problem.plain_gap(&problem.series, &fit)
            };
            let [unknown, known] = [gap(&[]), gap(&[hidden])];
            assert!(known < 0.2 * unknown, "{hidden}: {known} {unknown}");
        }
    }

    #[test]
    fn where_the_sensor_characteristic_is_flat_the_prediction_is_constant() {
        let recording = made::recording(&[]);
        let series = &series::coarse(&recording, recording.horizon)[0];
        let far = series.windows.iter().map(|w| w.restart.value.abs());
        let far = far.fold(0.0, f64::max);
        let mut device = Device::nominal(&recording.model);
        // The characteristic has its maximum at the farthest reading.
        let flat = 1.5 * far;
        device.sensing.cubic = -1.0 / (3.0 * flat * flat);
        let predicted = Predictor::new(device, &recording).predict(series);
        let is_constant = |window: &Window| {
            let mut seen = predicted[window.samples.clone()].windows(2);
            seen.all(|pair| pair[0] == pair[1])
        };
        for window in &series.windows {
            assert_eq!(
                is_constant(window),
                window.restart.value.abs() > 0.996 * far
            );
        }
    }
}
