//! A replicate of a recording by parametric bootstrap: the motion of a fitted model, observed through the same sensor.

use crate::predict::Predictor;
use crate::windows::restart::Restart;
use crate::windows::series::{self, Series, Window};
use crate::windows::statistics::quantile;
use host_sim::sensors::Noise;
use recording::{Recording, Run};

/// Number of rows that suffices.
const MOST_ROWS: usize = 60_000;
/// Relative margin against rounding of a time.
const ROUNDING: f64 = 1e-6;
/// Mean squared residual of a cubic, over the noise variance, that noise rarely exceeds.
const LARGEST_RATIO: f64 = 4.0;
const SEED: u64 = 0x6861_7074_6963;

/// The motion of a model whose state is reset to the measured one before every even window. In the odd windows, and in the first one, the
/// predictions of the model then differ from the motion only through noise and restarts.
pub(crate) struct Replicate<'a> {
    recording: &'a Recording,
    /// Parts of the runs, with the positions of the model.
    motion: Recording,
    /// The sensor noise of each run.
    sensor_noise: Vec<SensorNoise>,
    /// Number of windows of each run before the part begins.
    skipped: Vec<usize>,
    /// The states to which the motion was reset in each run.
    resets: Vec<Vec<Restart>>,
    from_first: bool,
}

/// Noise of the position column of a run.
#[derive(Clone, Copy, Default)]
struct SensorNoise {
    /// Standard deviation of the added noise, in position units.
    noise: f64,
    correlation: f64,
    /// Quantization step, in position units; 0 for none.
    quantum: f64,
}

impl<'a> Replicate<'a> {
    /// The replicates by `predictor` that begin at the first and at the second window. The odd windows of one are the even windows of the
    /// other, so that an error in every other window is not missed.
    pub(crate) fn both(recording: &'a Recording, predictor: &Predictor) -> [Self; 2] {
        let of = |from_first| Self::of(recording, predictor, from_first);
        let (first, second) = rayon::join(|| of(true), || of(false));
        [first, second]
    }

    fn of(recording: &'a Recording, predictor: &Predictor, from_first: bool) -> Self {
        let rows: usize = recording.runs.iter().map(|run| run.time.len()).sum();
        let share = (MOST_ROWS as f64 / rows.max(1) as f64).min(1.0);
        let mut motion = Recording::new("", recording.horizon, recording.model);
        motion.restart_half_width = recording.restart_half_width;
        motion.sensors.clone_from(&recording.sensors);
        let kept = recording.runs.iter().map(|run| {
            let before = skipped(run, share, recording.horizon) + usize::from(!from_first);
            (part(run, share, before as f64 * recording.horizon), before)
        });
        let (runs, skipped) = kept.unzip();
        motion.runs = runs;
        let resolution = recording.sensor("position").resolution;
        let mut sensor_noise = vec![SensorNoise::default(); motion.runs.len()];
        let mut resets = vec![Vec::new(); motion.runs.len()];
        let all = series::full(&motion, 2.0 * recording.horizon);
        for mut series in series::as_parts_of(recording, all) {
            let seen = typical_noise(&series);
            if let Some(pid) = &recording.runs[series.run].controller {
                series.resample_inputs(pid, seen);
            }
            restart_where_smooth(&mut series, seen);
            begin_at_rest(&mut series, predictor);
            let correlation = series.correlation;
            // The measured noise contains the quantization error. With correlated noise the low-pass has filtered that error too, so it
            // is not added separately.
            let quantum = if correlation > 0.0 { 0.0 } else { resolution };
            let later = series.windows.iter().skip(1);
            resets[series.run] = later.map(|window| window.restart).collect();
            sensor_noise[series.run] = SensorNoise {
                noise: (seen.powi(2) - quantum.powi(2) / 12.0).max(0.0).sqrt(),
                correlation,
                quantum,
            };
            motion.runs[series.run].position = predictor.predict(&series);
        }
        Self {
            recording,
            motion,
            sensor_noise,
            skipped,
            resets,
            from_first,
        }
    }

    /// Number of windows of a run before the part begins.
    pub(crate) fn skipped(&self, run: usize) -> usize {
        self.skipped[run]
    }

    /// An observation of the motion through the sensor, and the series that are `cut` from it. Each `draw` gives different noise. Draws
    /// `2 n` and `2 n + 1` have noise of opposite sign, because an error in one direction can have a larger effect than one in the other.
    pub(crate) fn observed(
        &self,
        draw: u64,
        cut: fn(&Recording, f64) -> Vec<Series>,
    ) -> (Recording, Vec<Series>) {
        let mut observed = self.motion.clone();
        let mut noise = Noise::new(SEED.wrapping_add(draw / 2));
        let sign = if draw.is_multiple_of(2) { 1.0 } else { -1.0 };
        for (run, sensor_noise) in observed.runs.iter_mut().zip(&self.sensor_noise) {
            run.position = sensor_noise.observe(&run.position, &mut noise, sign);
        }
        let mut all = series::as_parts_of(self.recording, cut(&observed, observed.horizon));
        for series in &mut all {
            for state in &self.resets[series.run] {
                let before = state.time_s - 0.5 * observed.horizon;
                let at = series
                    .windows
                    .partition_point(|w| w.restart.time_s < before);
                let Some(window) = series.windows.get_mut(at) else {
                    break;
                };
                // The motion jumps at a reset, so a cubic across it does not give the state after it.
                let drawn = |deviation| sign * noise.next(deviation);
                let [value, slope] = state.errors(window.restart_noise, drawn);
                let seen = [state.value + value, state.slope + slope, state.curvature];
                window.restart = window.restart.at(seen);
            }
        }
        (observed, all)
    }

    /// Approximate number of evaluated windows.
    pub(crate) fn evaluated_count(&self) -> usize {
        let duration_s: f64 = self.motion.runs.iter().map(Run::duration_s).sum();
        (0.5 * duration_s / self.motion.horizon) as usize
    }

    /// True for the windows of a run that are evaluated.
    pub(crate) fn is_evaluated(&self, window: usize) -> bool {
        window % 2 == 1 || (window == 0 && self.from_first)
    }
}

impl SensorNoise {
    fn observe(&self, position: &[f64], noise: &mut Noise, sign: f64) -> Vec<f64> {
        let Self {
            noise: deviation,
            correlation,
            quantum,
        } = *self;
        let new = (1.0 - correlation.powi(2)).sqrt();
        let mut drift = noise.next(deviation);
        let observed = position.iter().map(|x| {
            drift = correlation * drift + noise.next(new * deviation);
            let observed = x + sign * drift;
            if quantum > 0.0 {
                (observed / quantum).round() * quantum
            } else {
                observed
            }
        });
        observed.collect()
    }
}

/// Continues the motion where no cubic fits the measured samples, because a restart at a kink or a jump has a wrong state.
fn restart_where_smooth(series: &mut Series, noise: f64) {
    let mut kept: Vec<Window> = Vec::with_capacity(series.windows.len());
    for window in series.windows.drain(..) {
        let fit = &window.restart;
        let has_kink = fit.residual > LARGEST_RATIO * fit.freedom * noise.powi(2);
        match kept.last_mut().filter(|_| has_kink) {
            Some(before) => before.samples.end = window.samples.end,
            None => kept.push(window),
        }
    }
    series.windows = kept;
}

/// Starts a run at standstill if that predicts its first window better. At a break-away the cubic through the first samples gives a wrong
/// velocity.
fn begin_at_rest(series: &mut Series, predictor: &Predictor) {
    let (Some(first), Some(&value)) = (series.windows.first(), series.position.first()) else {
        return;
    };
    let cubic = first.restart;
    let squares = |series: &Series| {
        let predicted = predictor.predict_shifted(series, [0.0, 0.0], |w| w == 0);
        series.squares(&series.windows[0], &predicted)
    };
    let moving = squares(series);
    series.windows[0].restart = cubic.at([value, 0.0, 0.0]);
    if squares(series) >= moving {
        series.windows[0].restart = cubic;
    }
}

fn typical_noise(series: &Series) -> f64 {
    let noises: Vec<f64> = series.windows.iter().map(|w| w.noise).collect();
    quantile(&noises, 0.5)
}

/// Number of windows before the middle `share` of a run.
fn skipped(run: &Run, share: f64, horizon_s: f64) -> usize {
    (0.5 * (1.0 - share) * run.duration_s() / horizon_s) as usize
}

/// A `share` of the rows of a run after the first `skipped_s`, with the columns that a prediction needs.
fn part(run: &Run, share: f64, skipped_s: f64) -> Run {
    let start_s = run.time.first().copied().unwrap_or(0.0);
    let first = run
        .time
        .partition_point(|t| *t < start_s + (1.0 - ROUNDING) * skipped_s);
    let count = (run.time.len() as f64 * share).ceil() as usize;
    let rows = first..(first + count).min(run.time.len());
    let part = |column: &[f64]| column[rows.clone()].to_vec();
    Run {
        input_time_std: run.input_time_std,
        input_sampling: run.input_sampling,
        numbers: run.numbers.clone(),
        ..Run::new(
            run.file.clone(),
            run.drive,
            part(&run.time),
            part(&run.input),
            part(&run.position),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use host_sim::device::Device;

    #[test]
    fn a_replicate_keeps_the_clock_of_the_session() {
        let mut recording = made::recording(&[]);
        let start_s = recording.runs[1].time[0];
        for time_s in &mut recording.runs[1].time {
            *time_s -= start_s;
        }
        let predictor = Predictor::new(Device::nominal(&recording.model), &recording);
        let whole = series::coarse(&recording, recording.horizon);
        assert!(whole[1].session_offset_s > 0.0);
        for replicate in Replicate::both(&recording, &predictor) {
            let (_, observed) = replicate.observed(0, series::coarse);
            for (part, whole) in observed.iter().zip(&whole) {
                assert_eq!(part.session_offset_s, whole.session_offset_s);
                assert_eq!(part.started_s, whole.started_s);
            }
        }
    }
}
