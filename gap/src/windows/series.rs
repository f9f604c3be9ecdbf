//! A run divided into prediction windows, each with its restart.

use super::averaging::Averaging;
use super::inputs::Inputs;
use super::noise;
use super::restart::Restart;
use super::torque_profiles::TorqueProfiles;
pub use super::window::Window;
use recording::{InputSampling, Recording, Run, low_pass_gain};
use std::ops::Range;

/// The samples of one run, as they are predicted, with their windows.
#[derive(Clone, Debug)]
pub struct Series {
    /// Index of the run in the recording.
    pub run: usize,
    /// Times of the positions, in the time of the run, s.
    pub time: Vec<f64>,
    /// Measured positions, in position units.
    pub position: Vec<f64>,
    /// Instant from which on each input is held, s. For averaged samples it is the time of the first row of the sample.
    pub input_time: Vec<f64>,
    /// Input of each position, held up to the next. For averaged samples it is the mean over their rows.
    pub input: Vec<f64>,
    /// Measured velocity at each input, in position units per s.
    pub(crate) velocity: Vec<f64>,
    /// Largest magnitude of the recorded input.
    pub(crate) largest_input: f64,
    /// The input between the samples in finer steps, for averaged samples and for slow rows whose inputs were sampled at instants.
    pub(crate) fine_input: Option<Inputs>,
    /// Interval over which each position is averaged, s; 0 for an instant.
    pub span_s: f64,
    /// Median sampling period of the rows, s.
    pub period_s: f64,
    /// Correlation of the noise of consecutive samples.
    pub correlation: f64,
    /// Offset from the time of the run to the clock of the session, s.
    pub session_offset_s: f64,
    /// First time of the run, s.
    pub started_s: f64,
    /// True if inputs preceded the first one: the series begins later than the recording of its file.
    pub(crate) continues: bool,
    /// Windows in the order of time, without gaps between them.
    pub windows: Vec<Window>,
    /// Correction of a predicted motion for the averaging of the samples.
    pub(crate) averaging: Averaging,
    /// Torque profiles of drives for the inputs.
    pub(crate) torque_profiles: TorqueProfiles,
}

/// Sampling period that suffices for any motion, s, and the longest period to which samples are averaged in long windows of long
/// recordings, s.
pub(crate) const FINE_PERIOD_S: f64 = 1e-3;
const LONGEST_PERIOD_S: f64 = 2e-3;
/// Number of samples of a window, and of a recording, that suffice.
const WINDOW_SAMPLES: f64 = 100.0;
const RECORDING_SAMPLES: f64 = 3000.0;

/// A run divided into windows, before its columns are copied.
struct Outline<'a> {
    recording: &'a Recording,
    run: usize,
    period_s: f64,
    correlation: f64,
    continues: bool,
    session_offset_s: f64,
    windows: Vec<Window>,
}

impl<'a> Outline<'a> {
    /// The outlines of all runs, restarted every `horizon_s`.
    fn of_runs(recording: &'a Recording, horizon_s: f64) -> impl Iterator<Item = Self> {
        let offsets_s = session_offsets(recording).into_iter().enumerate();
        offsets_s.map(move |(index, session_offset_s)| {
            let run = &recording.runs[index];
            let period_s = median_period(&run.time);
            let correlation = noise::correlation(recording, run, period_s);
            let continues = part_before(recording, index).is_some();
            Self {
                recording,
                run: index,
                period_s,
                correlation,
                continues,
                session_offset_s,
                windows: windows(recording, run, continues, horizon_s, period_s, correlation),
            }
        })
    }

    /// Number of samples of its windows if they are averaged to about `period_s`.
    fn samples(&self, period_s: f64) -> usize {
        let group = self.group(period_s);
        let windows = self.windows.iter();
        windows.map(|w| w.samples.len().div_ceil(group)).sum()
    }

    /// Number of rows per averaged sample for a period of about `period_s`.
    fn group(&self, period_s: f64) -> usize {
        ((period_s / self.period_s).round() as usize).max(1)
    }

    /// The series of all rows and windows.
    fn whole(&self) -> Series {
        let rows = self.recording.runs[self.run].len();
        self.series(0..rows, &self.windows)
    }

    /// The series of some windows, with their rows.
    fn block(&self, windows: Range<usize>) -> Series {
        let windows = &self.windows[windows];
        let first = windows.first().map_or(0, |w| w.samples.start);
        let last = windows.last().map_or(first, |w| w.samples.end);
        self.series(first..last, windows)
    }

    /// The series of some rows, and of windows within them.
    fn series(&self, rows: Range<usize>, windows: &[Window]) -> Series {
        let run = &self.recording.runs[self.run];
        let time = run.time[rows.clone()].to_vec();
        let velocity = self.velocity(rows.clone());
        let recorded = run.input[rows.clone()].to_vec();
        let (input, fine_input) = match run.input_sampling {
            InputSampling::Mean => (recorded, None),
            InputSampling::Point => along_lines(&time, &recorded, &velocity, self.period_s),
        };
        let windows = windows.iter().map(|window| Window {
            samples: window.samples.start - rows.start..window.samples.end - rows.start,
            ..window.clone()
        });
        Series {
            run: self.run,
            windows: windows.collect(),
            position: run.position[rows.clone()].to_vec(),
            input_time: time.clone(),
            time,
            input,
            velocity,
            largest_input: largest(&run.input),
            fine_input,
            span_s: 0.0,
            period_s: self.period_s,
            correlation: self.correlation,
            session_offset_s: self.session_offset_s,
            started_s: run.time.first().copied().unwrap_or(0.0),
            continues: self.continues || rows.start > 0,
            averaging: Averaging::default(),
            torque_profiles: TorqueProfiles::default(),
        }
    }

    /// Measured velocity at some rows, in position units per s, from the rows around each.
    fn velocity(&self, rows: Range<usize>) -> Vec<f64> {
        let run = &self.recording.runs[self.run];
        let Some((first_s, last_s)) = run.time.get(rows.start).zip(run.time[..rows.end].last())
        else {
            return Vec::new();
        };
        let half_width_s = self.recording.restart_half_width;
        let from = run.time.partition_point(|t| first_s - t > half_width_s);
        let to = run.time.partition_point(|t| t - last_s <= half_width_s);
        let from = from.min(rows.start.saturating_sub(1));
        let to = to.max(rows.end + 1).min(run.len());
        let around = slopes(&run.time[from..to], &run.position[from..to], half_width_s);
        around[rows.start - from..rows.end - from].to_vec()
    }
}

impl Series {
    /// Time of sample `i` on the clock of the session, s.
    pub fn session(&self, i: usize) -> f64 {
        self.time[i] + self.session_offset_s
    }

    /// First and last time on the clock of the session, s. Returns `None` for a series without samples.
    pub(crate) fn session_span_s(&self) -> Option<[f64; 2]> {
        let last = self.time.len().checked_sub(1)?;
        Some([self.session(0), self.session(last)])
    }

    /// Usual time from a position to the next, s.
    pub(crate) fn step_s(&self) -> f64 {
        self.span_s.max(self.period_s)
    }

    /// Delay of the low-pass of the position column for a ramp, s. The low-pass runs once per sampling period.
    pub(crate) fn logged_lag_s(&self, cutoff_hz: Option<f64>) -> f64 {
        let gain = low_pass_gain(cutoff_hz, self.period_s);
        self.period_s * (1.0 - gain) / gain
    }

    /// Usual time from a restart to the next, s. It is infinite if there is only one restart.
    pub(crate) fn window_s(&self) -> f64 {
        let [Some(first), Some(last)] = [self.windows.first(), self.windows.last()] else {
            return f64::INFINITY;
        };
        let steps = self.windows.len() - 1;
        if steps == 0 {
            return f64::INFINITY;
        }
        (last.restart.time_s - first.restart.time_s) / steps as f64
    }

    /// Speed at the begin of each window, in position units per s.
    pub(crate) fn restart_speeds(&self) -> impl Iterator<Item = f64> {
        let windows = self.windows.iter();
        windows.map(|window| window.restart.slope.abs())
    }

    /// Sum of the squared prediction errors of a window.
    pub(crate) fn squares(&self, window: &Window, predicted: &[f64]) -> f64 {
        let rows = window.samples.clone();
        let pairs = predicted[rows.clone()].iter().zip(&self.position[rows]);
        pairs.map(|(p, m)| (p - m).powi(2)).sum()
    }

    /// Averages rows to samples of about `period_s`, position and input alike. The restarts stay unchanged. The inertia of a device
    /// filters faster changes of the torque.
    fn coarsened(self, period_s: f64) -> Self {
        let period = self.period_s;
        let group = (period_s / period).round() as usize;
        if group < 2 {
            return self;
        }
        let mut coarse = Self {
            time: Vec::new(),
            position: Vec::new(),
            input_time: Vec::new(),
            input: Vec::new(),
            velocity: Vec::new(),
            fine_input: None,
            span_s: group as f64 * period,
            correlation: self.correlation.powi(group as i32),
            windows: Vec::new(),
            averaging: Averaging::default(),
            torque_profiles: TorqueProfiles::default(),
            ..self
        };
        let noise_ratio = noise::noise_of_mean(group, self.correlation);
        let mut firsts = Vec::new();
        let mut instants_s = Vec::new();
        for window in &self.windows {
            let start = coarse.time.len();
            let mut spreads_s2 = Vec::new();
            for first in window.samples.clone().step_by(group) {
                let rows = first..(first + group).min(window.samples.end);
                let at_s = mean(&self.time[rows.clone()]);
                let distances_s2 = self.time[rows.clone()].iter().map(|t| (t - at_s).powi(2));
                spreads_s2.push(distances_s2.sum::<f64>() / rows.len() as f64);
                coarse.time.push(at_s);
                coarse.position.push(mean(&self.position[rows]));
                coarse.input_time.push(self.time[first]);
                firsts.push(first);
            }
            // Intervals of the fine input: from a restart to its first sample, then two halves between consecutive samples.
            let times = &coarse.time[start..];
            instants_s.push(self.time[window.samples.start]);
            instants_s.extend(&times[..1]);
            instants_s.extend(times.windows(2).flat_map(|t| [0.5 * (t[0] + t[1]), t[1]]));
            coarse
                .averaging
                .add_window(&coarse.time[start..], &spreads_s2);
            coarse.windows.push(Window {
                samples: start..coarse.time.len(),
                noise: noise_ratio * window.noise,
                ..window.clone()
            });
        }
        let held_s = |row: usize| {
            self.time
                .get(row + 1)
                .map_or(period, |t| t - self.time[row])
        };
        let ends = firsts.iter().skip(1).copied().chain([self.time.len()]);
        for (&first, end) in firsts.iter().zip(ends) {
            let all_s: f64 = (first..end).map(held_s).sum();
            let weighted = (first..end).map(|row| held_s(row) * self.input[row]);
            coarse.input.push(weighted.sum::<f64>() / all_s);
            coarse.velocity.push(mean(&self.velocity[first..end]));
        }
        instants_s.extend(self.time.last().map(|last_s| last_s + period));
        coarse.fine_input = Some(Inputs::between(
            &instants_s,
            &self.time,
            &self.input,
            &self.velocity,
        ));
        coarse
    }
}

/// Number of equal intervals in which a linear input within a slow row is replaced by its means. The error that remains in the motion is
/// 1/16 of that with one interval.
const LINE_PARTS: f64 = 4.0;

/// The mean input of each row, from inputs that were sampled at the instants of the rows, and the fine input if the rows are slow.
fn along_lines(
    time: &[f64],
    input: &[f64],
    velocity: &[f64],
    period_s: f64,
) -> (Vec<f64>, Option<Inputs>) {
    let means = Inputs::along(time, input, velocity, 1);
    let parts = (period_s / FINE_PERIOD_S).round().min(LINE_PARTS) as usize;
    let fine_input = (parts > 1).then(|| Inputs::along(time, input, velocity, parts));
    (means.means(), fine_input)
}

/// Slope of a column at each sample, per s: the difference quotient of the first and the last sample within `half_width_s`, or at least
/// of the adjacent samples.
pub(crate) fn slopes(time: &[f64], column: &[f64], half_width_s: f64) -> Vec<f64> {
    let [mut first, mut last] = [0; 2];
    let within = |from: usize, to: usize| time[to] - time[from] <= half_width_s;
    let slopes = (0..time.len()).map(|i| {
        while !within(first, i) {
            first += 1;
        }
        while last + 1 < time.len() && (last < i + 1 || within(i, last + 1)) {
            last += 1;
        }
        let before = first.min(i.saturating_sub(1));
        let passed_s = time[last] - time[before];
        if passed_s > 0.0 {
            (column[last] - column[before]) / passed_s
        } else {
            0.0
        }
    });
    slopes.collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Largest magnitude of the values.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Median difference of consecutive times, s.
pub fn median_period(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() {
        return FINE_PERIOD_S;
    }
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Index of the preceding run if it is an earlier part of the same file.
fn part_before(recording: &Recording, index: usize) -> Option<usize> {
    let before = index.checked_sub(1)?;
    let [earlier, later] = [&recording.runs[before], &recording.runs[index]];
    (earlier.file == later.file && earlier.time.last() < later.time.first()).then_some(before)
}

fn windows(
    recording: &Recording,
    run: &Run,
    continues: bool,
    horizon_s: f64,
    period_s: f64,
    correlation: f64,
) -> Vec<Window> {
    let (Some(&start), Some(&end)) = (run.time.first(), run.time.last()) else {
        return Vec::new();
    };
    let rounding_s = 1e-6 * period_s;
    let count = ((end - start + 2.0 * rounding_s) / horizon_s).floor() as usize + 1;
    let mut from = 0;
    let mut windows = Vec::with_capacity(count);
    for k in 0..count {
        let restart_s = start + k as f64 * horizon_s;
        let to = run
            .time
            .partition_point(|&t| t < restart_s + horizon_s - rounding_s);
        if to > from {
            // A window that begins in motion, where a file was split, has samples on one side only. It uses twice the half width for as
            // many samples.
            let sides = if k == 0 && continues { 2.0 } else { 1.0 };
            let half_width = sides * recording.restart_half_width;
            if let Some(restart) = Restart::fit(&run.time, &run.position, restart_s, half_width) {
                windows.push(Window {
                    samples: from..to,
                    restart: restart.correlated(&run.time, correlation),
                    noise: 0.0,
                    restart_noise: 0.0,
                });
            }
        }
        from = to;
    }
    noise::assign(recording, run, correlation, &mut windows);
    windows
}

/// All runs at full rate, restarted every `horizon_s`.
pub fn full(recording: &Recording, horizon_s: f64) -> Vec<Series> {
    each_full(recording, horizon_s).collect()
}

/// All runs at full rate, restarted every `horizon_s`, one at a time. A long session is then never held in memory twice.
pub(crate) fn each_full(recording: &Recording, horizon_s: f64) -> impl Iterator<Item = Series> {
    Outline::of_runs(recording, horizon_s).map(|outline| outline.whole())
}

/// All runs averaged to samples of 1 ms, or up to 2 ms if windows and recording are long, restarted every `horizon_s`.
pub fn coarse(recording: &Recording, horizon_s: f64) -> Vec<Series> {
    spread(recording, horizon_s, coarse_period_s(recording), usize::MAX)
}

/// All runs averaged as by [`coarse`], restarted every `horizon_s`. Of a long recording it takes about `most` samples, in blocks of
/// windows that are spread evenly.
pub fn some_coarse(recording: &Recording, horizon_s: f64, most: usize) -> Vec<Series> {
    spread(recording, horizon_s, coarse_period_s(recording), most)
}

/// All runs averaged to samples of about 1 ms, restarted every `horizon_s`. Of a long recording it takes about `most` samples, in blocks
/// of windows that are spread evenly.
pub fn some_fine(recording: &Recording, horizon_s: f64, most: usize) -> Vec<Series> {
    spread(recording, horizon_s, FINE_PERIOD_S, most)
}

fn coarse_period_s(recording: &Recording) -> f64 {
    let all_s: f64 = recording.runs.iter().map(Run::duration_s).sum();
    let enough_s = (recording.horizon / WINDOW_SAMPLES).min(all_s / RECORDING_SAMPLES);
    enough_s.clamp(FINE_PERIOD_S, LONGEST_PERIOD_S)
}

/// Number of consecutive windows in a block of a thinned recording. The state that is carried from window to window needs some windows to
/// settle.
const BLOCK: usize = 8;

/// Number of samples that suffices to compare rival models.
pub(crate) const MOST_SAMPLES: usize = 60_000;

/// All windows, or evenly spread blocks of windows if all windows hold more than `most` samples. The columns are copied one block at a
/// time, so that a long recording is never held in memory twice.
fn spread(recording: &Recording, horizon_s: f64, period_s: f64, most: usize) -> Vec<Series> {
    let outlines: Vec<Outline<'_>> = Outline::of_runs(recording, horizon_s).collect();
    let total: usize = outlines.iter().map(|o| o.samples(period_s)).sum();
    if total <= most {
        let whole = outlines.iter().map(Outline::whole);
        return whole.map(|series| series.coarsened(period_s)).collect();
    }
    let share = most as f64 / total as f64;
    let blocks = outlines.iter().flat_map(|outline| {
        let count = outline.windows.len().div_ceil(BLOCK);
        let kept = ((count as f64 * share).round() as usize).max(1);
        (0..kept).map(move |k| {
            let block = (2 * k + 1) * count / (2 * kept);
            let last = outline.windows.len();
            let windows = (block * BLOCK).min(last)..((block + 1) * BLOCK).min(last);
            outline.block(windows).coarsened(period_s)
        })
    });
    blocks.collect()
}

/// Gives the series of parts of runs the clocks of the whole runs.
pub(crate) fn as_parts_of(recording: &Recording, mut parts: Vec<Series>) -> Vec<Series> {
    let offsets = session_offsets(recording);
    for part in &mut parts {
        part.session_offset_s = offsets[part.run];
        part.started_s = recording.runs[part.run].time[0];
    }
    parts
}

/// Time of the first sample of a session on the clock of the session, s.
pub(crate) fn session_start(recording: &Recording) -> f64 {
    let starts = recording.runs.iter().zip(session_offsets(recording));
    let starts = starts.filter_map(|(run, offset)| Some(run.time.first()? + offset));
    starts.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// Offset from the time of each run to the clock of the session, s. The offsets are zero if the times of the runs do not overlap.
/// Otherwise the runs follow each other in the order of the list.
pub(crate) fn session_offsets(recording: &Recording) -> Vec<f64> {
    let mut spans: Vec<(f64, f64)> = recording
        .runs
        .iter()
        .filter_map(|run| Some((*run.time.first()?, *run.time.last()?)))
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    if spans.windows(2).all(|pair| pair[0].1 <= pair[1].0) {
        return vec![0.0; recording.runs.len()];
    }
    let mut clock = 0.0;
    let mut offsets: Vec<f64> = Vec::with_capacity(recording.runs.len());
    for (index, run) in recording.runs.iter().enumerate() {
        let start = run.time.first().copied().unwrap_or(0.0);
        // A part of the preceding run has the offset of that run.
        let part_before = part_before(recording, index);
        let offset = part_before.map_or(clock - start, |before| offsets[before]);
        offsets.push(offset);
        // The last sample lasts one period, after which the next run begins.
        let periods = run.time.len().saturating_sub(1).max(1) as f64;
        clock = start + offset + run.duration_s() * (1.0 + 1.0 / periods);
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::device::Device;
    use recording::Model;

    const PERIOD_S: f64 = 2.5e-4;
    const HORIZON_S: f64 = 0.1;
    const LIMIT: f64 = 1.0;
    const ROUNDING_S: f64 = 1e-6;

    /// An input that changes its sign with each window and exceeds the limit at the begin of each window.
    fn stepping() -> Recording {
        let time: Vec<f64> = (0..1200).map(|i| f64::from(i) * PERIOD_S).collect();
        let input = time.iter().map(|t| {
            let window = (t / HORIZON_S + 1e-6).floor();
            let sign = if window % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let spike = t - window * HORIZON_S < 2.5 * PERIOD_S;
            sign * if spike { 7.0 * LIMIT } else { 0.5 * LIMIT }
        });
        let input = input.collect();
        let position = time.iter().map(|t| t.sin()).collect();
        let model = Model {
            input_limit: Some(LIMIT),
            ..Model::new(1.0)
        };
        let mut recording = Recording::new("stepping", HORIZON_S, model);
        let run = Run::new("run.csv", recording::Drive::OpenLoop, time, input, position);
        recording.runs.push(run);
        recording
    }

    #[test]
    fn averaging_samples_keeps_the_impulse_in_each_window() {
        let recording = stepping();
        let series = &coarse(&recording, HORIZON_S)[0];
        assert!(series.time.len() < recording.runs[0].time.len() / 3);
        let fine_input = series.fine_input.as_ref().unwrap();
        let drive = Device::nominal(&recording.model).drive;
        for k in 0..2 {
            let start_s = k as f64 * HORIZON_S;
            let inside = |i: &usize| fine_input.time[*i] > start_s - ROUNDING_S;
            let before = |i: &usize| fine_input.time[*i] < start_s + HORIZON_S - ROUNDING_S;
            let rows = (0..fine_input.time.len()).filter(inside).take_while(before);
            let lasts_s = |i: usize| fine_input.time[i + 1] - fine_input.time[i];
            let impulse: f64 = rows
                .map(|i| fine_input.settled_nm(&drive, false, i) * lasts_s(i))
                .sum();
            let sign = if k == 0 { 1.0 } else { -1.0 };
            let acting = sign * LIMIT * (3.0 * PERIOD_S + 0.5 * (HORIZON_S - 3.0 * PERIOD_S));
            assert!((impulse - acting).abs() < 1e-9, "{impulse} {acting}");
        }
    }

    #[test]
    fn a_ramp_has_a_constant_slope_even_at_its_ends_and_next_to_a_gap() {
        const VELOCITY: f64 = -3.0;
        let time = [0.0, 0.001, 0.002, 0.003, 0.05, 0.051, 0.052];
        let position = time.map(|t| VELOCITY * t);
        let is_right = |v: &f64| (v - VELOCITY).abs() < 1e-9;
        for half_width_s in [0.0, 0.0015, 1.0] {
            let found = slopes(&time, &position, half_width_s);
            assert!(found.len() == time.len() && found.iter().all(is_right));
        }
        assert_eq!(slopes(&time[..1], &position[..1], 0.01), [0.0]);
    }

    #[test]
    fn two_runs_of_a_session_never_share_an_instant() {
        let mut recording = stepping();
        recording.runs.push(recording.runs[0].clone());
        let series = full(&recording, HORIZON_S);
        let [_, last] = series[0].session_span_s().unwrap();
        assert!((series[1].session(0) - last - PERIOD_S).abs() < 1e-9);
    }
}
