//! A recording as the estimate sees it: stretches without missing rows, at about a millisecond a row.

use crate::windows::series::{FINE_PERIOD_S, median_period, session_offsets};
use crate::windows::unbroken::Unbroken;
use core::ops::Range;
use host_sim::device::Device;
use host_sim::drive::{Drive, DriveLine};
use recording::{Recording, Run, low_pass_gain, sixth_differences};

/// Rows of the whole recording that suffice; longer ones are averaged to at most [`COARSEST_S`] a row.
const ENOUGH_ROWS: f64 = 40_000.0;
/// See [`ENOUGH_ROWS`].
const COARSEST_S: f64 = 4e-3;
/// Median size of a sixth difference of white noise over its standard deviation.
const MEDIAN_SIXTH_DIFFERENCE: f64 = 20.5;

/// Rows of one run that follow each other without a gap.
#[derive(Clone, Debug)]
pub(crate) struct Stretch {
    /// Index of the run in the recording.
    pub run: usize,
    /// In the flat columns of [`Samples`].
    pub rows: Range<usize>,
    /// What was told, at full rate.
    told: Told,
}

/// The input of a stretch at full rate.
#[derive(Clone, Debug)]
struct Told {
    /// s, in the run's time, from which each input is held.
    time_s: Vec<f64>,
    input: Vec<f64>,
    /// Velocity at each, which a drive with a no-load speed needs.
    velocity: Vec<f64>,
}

/// All rows of a recording, one column a quantity, one stretch behind the other.
///
/// A step leads from a row to the next; that of the last row of a stretch has no length.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    /// In the order of the recording.
    pub stretches: Vec<Stretch>,
    /// Of each row in its run's time, s.
    pub time_s: Vec<f64>,
    /// Of each row on the session's clock, s.
    pub session_s: Vec<f64>,
    /// Measured.
    pub position: Vec<f64>,
    /// Length of each step, s.
    pub step_s: Vec<f64>,
    /// Mean input over each step.
    pub input: Vec<f64>,
    /// Standard deviation of a row by sensor noise and quantising, as stated.
    pub noise: Vec<f64>,
    /// Median step, s.
    pub period_s: f64,
    /// Time by which the low-pass of the logged column is behind, s.
    logged_lag_s: f64,
}

impl Samples {
    /// Of a recording.
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
                seen_noise(run)
            };
            let gain = low_pass_gain(sensor.cutoff_hz, period_s);
            samples.logged_lag_s = period_s * (1.0 - gain) / gain;
            samples.push(run, index, offsets[index], group, noise);
        }
        samples.period_s = median_period(&samples.time_s);
        samples.input = samples.of_told(|told| told.input.clone());
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
            told: Told {
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

    /// Mean torque that `drive` makes of the input over each step, in units of input times its ratio.
    pub fn drive(&self, drive: &Drive) -> Vec<f64> {
        if drive.delay_s == 0.0 && drive.lag_s == 0.0 && drive.further_lag_s == 0.0 {
            return self.of_told(|told| {
                let pairs = told.input.iter().zip(&told.velocity);
                pairs.map(|(u, v)| drive.settled_at(*u, *v)).collect()
            });
        }
        self.of_told(|told| {
            let mut line = DriveLine::at_rest(drive);
            let mut means = Vec::with_capacity(told.time_s.len());
            for (i, &now_s) in told.time_s.iter().enumerate() {
                let end_s = told.time_s.get(i + 1).copied();
                let lasts_s = end_s.map_or(self.period_s, |end_s| end_s - now_s);
                line.command(drive, now_s, told.input[i], told.velocity[i]);
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

    /// Means over each step of what `held` makes of each stretch at full rate, held from row to row.
    fn of_told(&self, held: impl Fn(&Told) -> Vec<f64>) -> Vec<f64> {
        let mut means = vec![0.0; self.len()];
        for stretch in &self.stretches {
            let told = &stretch.told;
            let values = held(told);
            let mut at = 0;
            // Integral from the first row to `time_s`, with `at` as the row that holds then.
            let mut sums = Vec::with_capacity(values.len());
            let mut sum = 0.0;
            for (i, value) in values.iter().enumerate() {
                sums.push(sum);
                let next_s = told.time_s.get(i + 1).copied().unwrap_or(told.time_s[i]);
                sum += value * (next_s - told.time_s[i]);
            }
            let mut integral = |time_s: f64| {
                while at + 1 < told.time_s.len() && told.time_s[at + 1] <= time_s {
                    at += 1;
                }
                sums[at] + values[at] * (time_s - told.time_s[at]).max(0.0)
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

/// The nominal device's mean torque of the input over each step.
pub(crate) fn nominal_drive(samples: &Samples, device: &Device) -> Vec<f64> {
    samples.drive(&device.drive)
}

/// Standard deviation of the noise that the position itself shows.
fn seen_noise(run: &Run) -> f64 {
    let mut sizes: Vec<f64> = sixth_differences(&run.position).map(f64::abs).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        return f64::MIN_POSITIVE;
    }
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let largest = run.position.iter().fold(0.0, |m: f64, x| x.abs().max(m));
    // A position that stands still shows none; digits of the number format remain.
    (median / MEDIAN_SIXTH_DIFFERENCE)
        .max(1e-7 * largest)
        .max(f64::MIN_POSITIVE)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
