//! Windowed prediction: what a device would have done with the recorded input.

use crate::windows::drive_response::DriveResponse;
use crate::windows::series::{FINE_PERIOD_S, Series, Window, session_start};
use core::f64::consts::TAU;
use host_sim::decay::Decay;
use host_sim::device::Device;
use host_sim::plant::{Follower, Plant, State};
use host_sim::sensing::Reading;
use recording::{Recording, Sensor, low_pass_gain};
use std::collections::BTreeMap;

/// A device and the low-pass already in the logged column.
#[derive(Clone, Debug)]
pub struct Predictor {
    device: Device,
    plant: Plant,
    sensor: Sensor,
    /// Whether the sensor reads the position as it is.
    reads_as_is: bool,
    /// How much later the input of each run acts than is stated, s; as stated in runs beyond.
    input_shifts_s: Vec<f64>,
    /// The device of each run that states numbers of its own, by the run's place in the recording.
    loaded: BTreeMap<usize, Device>,
}

/// Displacement of every restart state, in standard deviations of the fit of value and slope.
pub type Shift = [f64; 2];

/// Rate of what samples that are put together still follow, rad/s.
const FASTEST_RATE: f64 = 0.25 * TAU / FINE_PERIOD_S;

/// Distance from its restart at which a model has run away, over the span of what was measured and how far the largest torque
/// would take a free device: what sticks throughout spans nothing.
const FARTHEST: f64 = 100.0;

fn span(values: &[f64]) -> f64 {
    let extremes = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), extremes);
    (high - low).max(f64::MIN_POSITIVE)
}

/// Share of a speed that shows down to which the slope of the reading tells it.
const LEAST_SHOWN: f64 = 0.5;
/// Time constants after which what is carried over has died away, to a thousandth: gaps of as many floors are met.
const SETTLED: f64 = 7.0;
/// Windows that lead up to a wanted one at most, and how many are gone through for each that is wanted.
const MOST_LEAD: usize = 8;
const MOST_TAKEN: f64 = 2.5;

struct Running {
    state: State,
    reading: Reading,
    shown: f64,
    filtered: f64,
    /// When the column was last read, in the run's time.
    read_s: f64,
    /// Time constant of the column's own low-pass, s.
    logged_s: f64,
    /// Of what the column's own low-pass has to forget.
    fading: Decay,
}

impl Predictor {
    /// Predicts with `device` what the recording's `position` column shows.
    pub fn new(mut device: Device, recording: &Recording) -> Self {
        let mechanics = &mut device.mechanics;
        // Harder links are the same to the samples, at many times the steps.
        let link = mechanics.link;
        mechanics.link = link.map(|link| link.bounded(mechanics.inertia, FASTEST_RATE));
        if let Some(drift) = &mut mechanics.friction.drift {
            drift.start_s = session_start(recording);
        }
        let own = recording.runs.iter().enumerate();
        let own = own.filter(|(_, run)| !run.numbers.is_empty());
        let loaded = own.map(|(place, run)| {
            let own = recording.model_of(run);
            (place, device.with_load(&recording.model, &own))
        });
        Self {
            loaded: loaded.collect(),
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
            loaded: BTreeMap::new(),
        }
    }

    /// The same with an input that acts so much later than is stated in each run, s, or earlier.
    pub(crate) fn shifted(self, input_shifts_s: Vec<f64>) -> Self {
        Self {
            input_shifts_s,
            ..self
        }
    }

    /// The device with the load of the recording's `[model]`.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// One predicted position a sample.
    pub fn predict(&self, series: &Series) -> Vec<f64> {
        self.predict_shifted(series, [0.0, 0.0], |_| true)
    }

    /// The same from displaced restarts, for the windows (by index) that are wanted; elsewhere it
    /// stays zero.
    pub fn predict_shifted(
        &self,
        series: &Series,
        shift: Shift,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<f64> {
        match self.in_run(series) {
            Some(own) => own.through(series, shift, wanted),
            None => self.through(series, shift, wanted),
        }
    }

    /// The same with the load of a run, and with what starts anew with its clock; none where neither is another.
    fn in_run(&self, series: &Series) -> Option<Self> {
        let loaded = self.loaded.get(&series.run);
        let mut device = loaded.unwrap_or(&self.device).clone();
        let drift = device.mechanics.friction.drift.as_mut();
        let anew = drift.filter(|drift| drift.anew && series.session_offset_s != 0.0);
        if loaded.is_none() && anew.is_none() {
            return None;
        }
        if let Some(drift) = anew {
            drift.start_s = series.started_s + series.session_offset_s;
        }
        Some(Self::of(device, self.sensor).shifted(self.input_shifts_s.clone()))
    }

    fn through(&self, series: &Series, shift: Shift, wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let remembers = self.remembers();
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
        let low_passes = low_passes.into_iter().filter(|there| *there).count();
        let mut drive = self.device.drive.clone();
        drive.delay_s += self.input_shifts_s.get(series.run).unwrap_or(&0.0);
        let response = DriveResponse::new(&drive, series);
        let taken = self.taken(series, wanted);
        for (index, window) in series.windows.iter().enumerate() {
            if !taken[index] {
                continue;
            }
            let restart_s = window.restart.time_s;
            let follows = remembers && (index == 0 || taken[index - 1]);
            let samples = window.samples.clone();
            response.in_window(index, |course| {
                if follows {
                    let mut seen = [0.0];
                    follower.follow(&mut running.state, &course.lead, response.gain, &mut seen);
                    self.read(&mut running, series, seen[0], restart_s);
                }
                let x = self.restart(&mut running, series, window, shift, follows);
                let seen = &mut predicted[samples.clone()];
                // What is not known to be anywhere cannot be followed.
                if self.device.sensing.is_flat(x) {
                    seen.fill(x);
                    return;
                }
                follower.follow(&mut running.state, &course.steps, response.gain, seen);
                series.averaging.apply(samples.start, seen, low_passes);
            });
            running.read_s = restart_s;
            let window_s = series.time[samples.end - 1] - restart_s;
            let farthest = FARTHEST * (span + self.free_travel(series, window_s));
            for i in samples {
                predicted[i] = self.read(&mut running, series, predicted[i], series.time[i]);
                let strayed = (predicted[i] - window.restart.value).abs();
                if strayed.is_nan() || strayed > farthest {
                    self.give_up(&mut running, series, window, &mut predicted[i..]);
                    break;
                }
            }
        }
        predicted
    }

    /// Ends a window in which the model runs away: it stays where it is, and what it carries is relaxed.
    fn give_up(&self, running: &mut Running, series: &Series, window: &Window, rest: &mut [f64]) {
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

    /// How far the largest torque takes a free device within a time.
    fn free_travel(&self, series: &Series, within_s: f64) -> f64 {
        let Device {
            drive, mechanics, ..
        } = &self.device;
        let torque_nm = drive.settled(series.largest_input).abs() + mechanics.gravity.abs();
        0.5 * torque_nm / mechanics.inertia * within_s.powi(2)
    }

    /// True if anything but the drive is carried from window to window.
    fn remembers(&self) -> bool {
        let mechanics = &self.device.mechanics;
        mechanics.link.is_some()
            || mechanics.presliding.is_some()
            || !self.device.sensing.hysteresis.is_none()
            || self.device.sensing.lag_s > 0.0
            || !self.device.sensing.overspeed.is_none()
    }

    /// The windows to go through for those that are wanted: with some before them in which what is carried over
    /// settles.
    fn taken(&self, series: &Series, wanted: impl Fn(usize) -> bool) -> Vec<bool> {
        let count = series.windows.len();
        let wanted: Vec<bool> = (0..count).map(wanted).collect();
        let number = |of: &[bool]| of.iter().filter(|taken| **taken).count();
        let most = MOST_TAKEN * number(&wanted) as f64;
        let with = |lead: usize| -> Vec<bool> {
            let ahead = |index: usize| index..count.min(index + lead + 1);
            (0..count)
                .map(|index| wanted[ahead(index)].contains(&true))
                .collect()
        };
        let longest = self.lead(series);
        let mut leads = (1..=longest).rev().map(with);
        let affordable = leads.find(|taken| number(taken) as f64 <= most);
        affordable.unwrap_or_else(|| with(longest.min(1)))
    }

    /// Windows before a wanted one in which what is carried over settles.
    fn lead(&self, series: &Series) -> usize {
        if !self.remembers() {
            return 0;
        }
        let mechanics = &self.device.mechanics;
        let sensing = &self.device.sensing;
        let plays =
            !sensing.hysteresis.is_none() || mechanics.link.is_some_and(|link| link.play > 0.0);
        if plays || mechanics.presliding.is_some() || !sensing.overspeed.is_none() {
            // Where a play or a bristle stands, or a counter, is known once the device has been followed for a while.
            return MOST_LEAD;
        }
        let rings_s = mechanics
            .link
            .map_or(0.0, |link| link.memory_s(mechanics.inertia));
        let lags_s = sensing.lag_s + sensing.further_lag_s;
        let windows = (SETTLED * rings_s.max(lags_s) / series.window_s()).ceil();
        // How fast the sensor lags more and more is known a window after the speed is.
        let speed = usize::from(sensing.lag_s > 0.0);
        (windows as usize + speed).clamp(1, MOST_LEAD)
    }

    /// Puts the device where the sensor shows it, and says where that is; what the sensor does not show goes on as it was if this
    /// follows the last window.
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
        // The column's own low-pass is undone; how far the sensor lags its slopes are too noisy to tell.
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
        // How far the reading stays behind cannot be seen; what moves comes to the farthest.
        let (inside, direction) = if follows {
            (running.reading.behind, seen_rate)
        } else {
            (hysteresis.half_width.copysign(rate), rate)
        };
        let x = sensing.inverse(behind + inside);
        // Of what hardly shows of the speed the slope of the reading says little, and within play nothing.
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

    /// How far the sensor lags, how fast that grows, and how far its further lag alone does.
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

    /// What the column shows of a position at an instant of the run.
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

    /// What the column's own low-pass, which goes on once a period, makes of a reading that goes evenly to `y` within
    /// `dt_s`: its recursion in closed form, as samples that are put together are periods apart.
    #[inline]
    fn low_passed(&self, running: &mut Running, series: &Series, y: f64, dt_s: f64) -> f64 {
        let Some(cutoff_hz) = self.sensor.cutoff_hz else {
            return y;
        };
        if dt_s <= 0.0 {
            return running.filtered;
        }
        let behind = running.logged_s * (y - running.shown) / dt_s;
        let bent = running.filtered - (running.shown - behind);
        let left = || 1.0 - low_pass_gain(Some(cutoff_hz), series.period_s);
        y - behind + bent * running.fading.over(dt_s, || left().ln() / series.period_s)
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
    fn what_is_carried_into_a_window_settles_in_those_before_it() {
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
    fn what_a_sensor_keeps_back_is_carried_on() {
        for hidden in [
            "sensor_hysteresis:width=0.03",
            "sensor_hysteresis:width=0.03,reach=0.045",
        ] {
            let recording = made::recording(&[hidden]);
            let problem = made::problem(&recording);
            let left = |known: &[&str]| {
                let terms = known.iter().map(|effect| made::written(effect)).collect();
                let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
                problem.plain_gap(&problem.series, &fit)
            };
            let [unknown, known] = [left(&[]), left(&[hidden])];
            assert!(known < 0.2 * unknown, "{hidden}: {known} {unknown}");
        }
    }

    #[test]
    fn where_the_sensor_shows_nothing_of_the_position_nothing_is_followed() {
        let recording = made::recording(&[]);
        let series = &series::coarse(&recording, recording.horizon)[0];
        let far = series.windows.iter().map(|w| w.restart.value.abs());
        let far = far.fold(0.0, f64::max);
        let mut device = Device::nominal(&recording.model);
        // It turns back at the farthest reading.
        let flat = 1.5 * far;
        device.sensing.cubic = -1.0 / (3.0 * flat * flat);
        let predicted = Predictor::new(device, &recording).predict(series);
        let stays = |window: &Window| {
            let mut seen = predicted[window.samples.clone()].windows(2);
            seen.all(|pair| pair[0] == pair[1])
        };
        for window in &series.windows {
            assert_eq!(stays(window), window.restart.value.abs() > 0.996 * far);
        }
    }
}
