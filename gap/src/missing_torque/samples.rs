//! The samples for the estimate: stretches without missing rows, at about 1 ms per row.

use crate::windows::series::{FINE_PERIOD_S, median_period, session_offsets};
use crate::windows::unbroken::Unbroken;
use core::ops::Range;
use host_sim::drive::{Drive, DriveLine};
use recording::{Recording, Run, low_pass_gain, sixth_differences};

/// Number of rows that suffices. Longer recordings are averaged to at most [`COARSEST_S`] per row.
const ENOUGH_ROWS: f64 = 40_000.0;
/// Longest period of averaged rows, s.
const COARSEST_S: f64 = 4e-3;
/// Median magnitude of the sixth difference of white noise, over its standard deviation.
const MEDIAN_SIXTH_DIFFERENCE: f64 = 20.5;

/// Rows of one run without a gap.
#[derive(Clone, Debug)]
pub(crate) struct Stretch {
    /// Index of the run in the recording.
    pub run: usize,
    /// Indices of the rows in the columns of [`Samples`].
    pub rows: Range<usize>,
    /// The input at full rate.
    input: FullRateInput,
}

/// The input of a stretch at full rate.
#[derive(Clone, Debug)]
struct FullRateInput {
    /// Time of the run from which on each input is held, s.
    time_s: Vec<f64>,
    input: Vec<f64>,
    /// Velocity at each input, for a drive with a no-load speed, in position units per s.
    velocity: Vec<f64>,
}

/// All rows of a recording, with one column per quantity and the stretches one after the other.
///
/// A step leads from one row to the next. The step of the last row of a stretch has zero length.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    /// The stretches in the order of the recording.
    pub stretches: Vec<Stretch>,
    /// Time of each row in its run, s.
    pub time_s: Vec<f64>,
    /// Time of each row on the clock of the session, s.
    pub session_s: Vec<f64>,
    /// Measured position, in position units.
    pub position: Vec<f64>,
    /// Length of each step, s.
    pub step_s: Vec<f64>,
    /// Mean input over each step.
    pub input: Vec<f64>,
    /// Standard deviation of each row from sensor noise and quantization, in position units.
    pub noise: Vec<f64>,
    /// Median step, s.
    pub period_s: f64,
    /// Delay of the low-pass of the logged column, s.
    logged_lag_s: f64,
}

impl Samples {
    /// Builds the samples of a recording.
    pub fn of(recording: &Recording) -> Self {
        let unbroken = Unbroken::of(recording);
        let offsets = session_offsets(recording);
        let sensor = recording.sensor("position");
        let all_s: f64 = recording.runs.iter().map(Run::duration_s).sum();
        let wanted_s = (all_s / ENOUGH_ROWS).clamp(FINE_PERIOD_S, COARSEST_S);
        let mut samples = Self {
            stretches: Vec::new(),
            time_s: Vec::new(),
            session_s: Vec::new(),
            position: Vec::new(),
            step_s: Vec::new(),
            input: Vec::new(),
            noise: Vec::new(),
            period_s: 0.0,
            logged_lag_s: 0.0,
        };
        for (run, &index) in unbroken.recording.runs.iter().zip(&unbroken.runs) {
            let period_s = median_period(&run.time);
            let group = (wanted_s / period_s).round().max(1.0) as usize;
            let stated = sensor.deviation();
            let noise = if stated > 0.0 {
                stated
            } else {
                estimated_noise(run)
            };
            let gain = low_pass_gain(sensor.cutoff_hz, period_s);
            samples.logged_lag_s = period_s * (1.0 - gain) / gain;
            samples.push(run, index, offsets[index], group, noise);
        }
        samples.period_s = median_period(&samples.time_s);
        samples.input = samples.mean_over_steps(|full| full.input.clone());
        samples
    }

    fn push(&mut self, run: &Run, index: usize, offset_s: f64, group: usize, noise: f64) {
        let start = self.time_s.len();
        let groups = run.time.chunks(group).zip(run.position.chunks(group));
        for (times, positions) in groups {
            let time_s = mean(times);
            self.time_s.push(time_s);
            self.session_s.push(time_s + offset_s);
            self.position.push(mean(positions));
            self.noise.push(noise / (times.len() as f64).sqrt());
        }
        let times = &self.time_s[start..];
        self.step_s
            .extend(times.windows(2).map(|pair| pair[1] - pair[0]));
        self.step_s.push(0.0);
        let half_width_s = Recording::RESTART_HALF_WIDTH;
        let velocity = crate::windows::series::slopes(&run.time, &run.position, half_width_s);
        self.stretches.push(Stretch {
            run: index,
            rows: start..self.time_s.len(),
            input: FullRateInput {
                time_s: run.time.clone(),
                input: run.input.clone(),
                velocity,
            },
        });
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Mean torque of `drive` over each step, in input units times its ratio.
    pub fn drive(&self, drive: &Drive) -> Vec<f64> {
        if drive.delay_s == 0.0 && drive.lag_s == 0.0 && drive.further_lag_s == 0.0 {
            return self.mean_over_steps(|input| {
                let pairs = input.input.iter().zip(&input.velocity);
                pairs.map(|(u, v)| drive.settled_at(*u, *v)).collect()
            });
        }
        self.mean_over_steps(|input| {
            let mut line = DriveLine::at_rest(drive);
            let mut means = Vec::with_capacity(input.time_s.len());
            for (i, &now_s) in input.time_s.iter().enumerate() {
                let end_s = input.time_s.get(i + 1).copied();
                let lasts_s = end_s.map_or(self.period_s, |end_s| end_s - now_s);
                line.command(drive, now_s, input.input[i], input.velocity[i]);
                let mut passed_s = 0.0;
                let mut impulse = 0.0;
                while lasts_s - passed_s > 1e-9 * lasts_s {
                    let (torque, piece_s) = line.piece(now_s + passed_s, lasts_s - passed_s);
                    impulse += torque.at(0.5 * piece_s) * piece_s;
                    passed_s += piece_s.max(1e-9 * lasts_s);
                }
                means.push(impulse / lasts_s);
            }
            means
        })
    }

    /// Mean over each step of a quantity at full rate. `held` computes it from the input of a stretch, and each value is held until the
    /// next row.
    fn mean_over_steps(&self, held: impl Fn(&FullRateInput) -> Vec<f64>) -> Vec<f64> {
        let mut means = vec![0.0; self.len()];
        for stretch in &self.stretches {
            let input = &stretch.input;
            let values = held(input);
            let mut at = 0;
            // Integral from the first row to `time_s`; `at` is the row that holds then.
            let mut sums = Vec::with_capacity(values.len());
            let mut sum = 0.0;
            for (i, value) in values.iter().enumerate() {
                sums.push(sum);
                let next_s = input.time_s.get(i + 1).copied().unwrap_or(input.time_s[i]);
                sum += value * (next_s - input.time_s[i]);
            }
            let mut integral = |time_s: f64| {
                while at + 1 < input.time_s.len() && input.time_s[at + 1] <= time_s {
                    at += 1;
                }
                sums[at] + values[at] * (time_s - input.time_s[at]).max(0.0)
            };
            let rows = stretch.rows.clone();
            let shift_s = self.logged_lag_s;
            let mut before = integral(self.time_s[rows.start] - shift_s);
            for row in rows {
                if self.step_s[row] > 0.0 {
                    let after = integral(self.time_s[row + 1] - shift_s);
                    means[row] = (after - before) / self.step_s[row];
                    before = after;
                }
            }
        }
        means
    }
}

/// Standard deviation of the noise, estimated from the position itself.
fn estimated_noise(run: &Run) -> f64 {
    let mut sizes: Vec<f64> = sixth_differences(&run.position).map(f64::abs).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        return f64::MIN_POSITIVE;
    }
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let largest = run.position.iter().fold(0.0, |m: f64, x| x.abs().max(m));
    // A constant position shows no noise, so the resolution of the number format is assumed.
    (median / MEDIAN_SIXTH_DIFFERENCE)
        .max(1e-7 * largest)
        .max(f64::MIN_POSITIVE)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
