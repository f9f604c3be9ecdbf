//! A replicate of a recording by parametric bootstrap: the motion of a fitted model, seen by the same sensor.

use crate::predict::Predictor;
use crate::windows::restart::Restart;
use crate::windows::series::{self, Series, Window};
use crate::windows::statistics::quantile;
use host_sim::sensors::Noise;
use recording::{Recording, Run};

/// Rows that suffice.
const MOST_ROWS: usize = 60_000;
/// Share of a time that rounding may take.
const HAIR: f64 = 1e-6;
/// Mean square that a cubic leaves in those of the noise which noise hardly exceeds.
const ROUGH: f64 = 4.0;
const SEED: u64 = 0x6861_7074_6963;

/// The motion of a model that is put where the device was before every even window. Its own predictions of the odd windows, and of
/// the first one, are off by noise and restarts alone.
pub(crate) struct Replicate<'a> {
    recording: &'a Recording,
    /// Parts of its runs, with the positions of the model.
    motion: Recording,
    /// Of each run.
    sensed: Vec<Sensed>,
    /// Windows of each run before it begins.
    skipped: Vec<usize>,
    /// Where it was put in each run.
    put: Vec<Vec<Restart>>,
    from_first: bool,
}

/// How a run is seen.
#[derive(Clone, Copy, Default)]
struct Sensed {
    /// Standard deviation of what is added.
    noise: f64,
    correlation: f64,
    /// 0 for none.
    quantum: f64,
}

impl<'a> Replicate<'a> {
    /// As `predictor` has it, from the first window on and from the second: odd windows of the one are even ones of the other, so
    /// that what recurs every other window is seen, too.
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
        let mut sensed = vec![Sensed::default(); motion.runs.len()];
        let mut put = vec![Vec::new(); motion.runs.len()];
        let all = series::full(&motion, 2.0 * recording.horizon);
        for mut series in series::as_parts_of(recording, all) {
            let seen = typical_noise(&series);
            if let Some(pid) = &recording.runs[series.run].controller {
                series.resample_inputs(pid, seen);
            }
            restart_where_smooth(&mut series, seen);
            begin_at_rest(&mut series, predictor);
            let correlation = series.correlation;
            // What is seen as noise has the quantising in it, which is filtered with it if it is.
            let quantum = if correlation > 0.0 { 0.0 } else { resolution };
            let later = series.windows.iter().skip(1);
            put[series.run] = later.map(|window| window.restart).collect();
            sensed[series.run] = Sensed {
                noise: (seen.powi(2) - quantum.powi(2) / 12.0).max(0.0).sqrt(),
                correlation,
                quantum,
            };
            motion.runs[series.run].position = predictor.predict(&series);
        }
        Self {
            recording,
            motion,
            sensed,
            skipped,
            put,
            from_first,
        }
    }

    /// Windows of a run before it begins.
    pub(crate) fn skipped(&self, run: usize) -> usize {
        self.skipped[run]
    }

    /// What a sensor may show of it, another each `draw`, and the series that are `cut` from that: every other has the noise of
    /// the one before it with the other sign, as an error to one side may do far more than one to the other.
    pub(crate) fn shown(
        &self,
        draw: u64,
        cut: fn(&Recording, f64) -> Vec<Series>,
    ) -> (Recording, Vec<Series>) {
        let mut shown = self.motion.clone();
        let mut noise = Noise::new(SEED.wrapping_add(draw / 2));
        let sign = if draw.is_multiple_of(2) { 1.0 } else { -1.0 };
        for (run, sensed) in shown.runs.iter_mut().zip(&self.sensed) {
            run.position = sensed.show(&run.position, &mut noise, sign);
        }
        let mut all = series::as_parts_of(self.recording, cut(&shown, shown.horizon));
        for series in &mut all {
            for state in &self.put[series.run] {
                let before = state.time_s - 0.5 * shown.horizon;
                let at = series
                    .windows
                    .partition_point(|w| w.restart.time_s < before);
                let Some(window) = series.windows.get_mut(at) else {
                    break;
                };
                // A cubic over the tear says nothing of what goes on from there.
                let drawn = |deviation| sign * noise.next(deviation);
                let [value, slope] = state.errors(window.restart_noise, drawn);
                let seen = [state.value + value, state.slope + slope, state.curvature];
                window.restart = window.restart.at(seen);
            }
        }
        (shown, all)
    }

    /// About how many windows show what is left.
    pub(crate) fn telling(&self) -> usize {
        let duration_s: f64 = self.motion.runs.iter().map(Run::duration_s).sum();
        (0.5 * duration_s / self.motion.horizon) as usize
    }

    /// True for the windows of a run that do.
    pub(crate) fn tells(&self, window: usize) -> bool {
        window % 2 == 1 || (window == 0 && self.from_first)
    }
}

impl Sensed {
    fn show(&self, position: &[f64], noise: &mut Noise, sign: f64) -> Vec<f64> {
        let Self {
            noise: deviation,
            correlation,
            quantum,
        } = *self;
        let new = (1.0 - correlation.powi(2)).sqrt();
        let mut drift = noise.next(deviation);
        let shown = position.iter().map(|x| {
            drift = correlation * drift + noise.next(new * deviation);
            let shown = x + sign * drift;
            if quantum > 0.0 {
                (shown / quantum).round() * quantum
            } else {
                shown
            }
        });
        shown.collect()
    }
}

/// Lets the motion go on where no cubic follows what was measured: a restart on a kink or a jump would lead astray.
fn restart_where_smooth(series: &mut Series, noise: f64) {
    let mut kept: Vec<Window> = Vec::with_capacity(series.windows.len());
    for window in series.windows.drain(..) {
        let fit = &window.restart;
        let rough = fit.residual > ROUGH * fit.freedom * noise.powi(2);
        match kept.last_mut().filter(|_| rough) {
            Some(before) => before.samples.end = window.samples.end,
            None => kept.push(window),
        }
    }
    series.windows = kept;
}

/// Lets a run begin at rest where that suits its first window better: the cubic through the first samples makes a speed
/// of a break-away.
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

/// Windows before the middle `share` of a run.
fn skipped(run: &Run, share: f64, horizon_s: f64) -> usize {
    (0.5 * (1.0 - share) * run.duration_s() / horizon_s) as usize
}

/// A `share` of a run's rows after the first `skipped_s`, with the columns that a prediction needs.
fn part(run: &Run, share: f64, skipped_s: f64) -> Run {
    let start_s = run.time.first().copied().unwrap_or(0.0);
    let first = run
        .time
        .partition_point(|t| *t < start_s + (1.0 - HAIR) * skipped_s);
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
    fn it_goes_by_the_clock_of_the_session() {
        let mut recording = made::recording(&[]);
        let start_s = recording.runs[1].time[0];
        for time_s in &mut recording.runs[1].time {
            *time_s -= start_s;
        }
        let predictor = Predictor::new(Device::nominal(&recording.model), &recording);
        let whole = series::coarse(&recording, recording.horizon);
        assert!(whole[1].session_offset_s > 0.0);
        for replicate in Replicate::both(&recording, &predictor) {
            let (_, shown) = replicate.shown(0, series::coarse);
            for (part, whole) in shown.iter().zip(&whole) {
                assert_eq!(part.session_offset_s, whole.session_offset_s);
                assert_eq!(part.started_s, whole.started_s);
            }
        }
    }
}
