//! Innovations: the errors of short predictions. They show where the gap arises, before the model carries the error on over a whole
//! horizon.

use crate::fit::whitening::whitenings;
use crate::predict::Predictor;
use crate::windows::restart::Restart;
use crate::windows::series::{Series, Window, median_period};
use rayon::prelude::*;

/// The error of one short prediction, with the motion during it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Innovation {
    /// Index, over all series, of the prediction window in which it begins.
    pub window: usize,
    /// Index of the run in the recording.
    pub run: usize,
    /// Mean time on the clock of the session, s.
    pub session_s: f64,
    /// Mean position, in the position unit of the recording.
    pub position: f64,
    /// Mean velocity, in position units per s.
    pub velocity: f64,
    /// Velocity of the smallest magnitude in this innovation and the ones shortly before, in position units per s. It is 0 if the motion
    /// reversed.
    pub slowest: f64,
    /// Mean acceleration, in position units per s².
    pub acceleration: f64,
    /// Mean input, in input units.
    pub input: f64,
    /// The input of the largest magnitude, with its sign.
    pub input_peak: f64,
    /// Mean input of the second half less that of the first half.
    pub input_change: f64,
    /// Half the range of the position.
    pub position_reach: f64,
    /// Half the range of the velocity.
    pub velocity_reach: f64,
    /// Half the range of the input.
    pub input_reach: f64,
    /// Number of samples.
    pub samples: f64,
    /// Sum of the squared whitened residuals less its expectation from noise alone, not below zero.
    pub excess: f64,
    /// Acceleration that the prediction lacks, in units of its standard deviation.
    pub missing: f64,
}

/// Coordinate of an innovation on an axis.
pub(super) type Coordinate = fn(&Innovation) -> f64;

impl Innovation {
    /// The excess by the robust loss of the fits, which limits the weight of a single event.
    pub(super) fn robust(&self) -> f64 {
        self.samples * (self.excess / self.samples).ln_1p()
    }

    /// The square root of the robust loss of the missing acceleration, with the sign of the missing acceleration.
    pub(super) fn robust_missing(&self) -> f64 {
        (self.missing * self.missing)
            .ln_1p()
            .sqrt()
            .copysign(self.missing)
    }

    /// Sign of the velocity: 1 or -1.
    pub(super) fn direction(&self) -> f64 {
        if self.velocity < 0.0 { -1.0 } else { 1.0 }
    }
}

/// Length of the shortest predictions, s.
const SHORTEST_S: f64 = 0.02;
/// Least length of a prediction in samples. Fewer samples do not separate a curvature from noise.
const FEWEST_SAMPLES: f64 = 10.0;
/// Ratio between the lengths of consecutive scales.
const GROWTH: f64 = 2.0;
/// Number of scales that are tried. Longer scales, up to the horizon, are tried while noise hides the gap.
const SCALES: i32 = 4;
/// Share of the excess in the squared innovations that noise alone may explain.
const LEAST_CLEAR: f64 = 0.1;
/// Share of the excess in the squared innovations beyond which no longer scale is tried.
const CLEAR_SHARE: f64 = 0.5;
/// Number of preceding innovations, which begin half a length apart, in which a reversal of the motion counts as close.
const BEFORE: usize = 2;
/// Factor by which the true noise variance may exceed the estimate.
const NOISE_DOUBT: f64 = 1.5;
/// Number of standard deviations of χ² that an innovation must exceed its expectation from noise to count.
const NOISE_MARGIN: f64 = 2.0;

/// The innovations of the shortest scale at which the excess exceeds [`CLEAR_SHARE`] of their squares, or else of the scale with the
/// largest share. Returns none if noise alone may explain the innovations of all scales.
///
/// Short predictions show where the gap arises; long ones propagate it. The acceleration error that noise hides is smaller for longer
/// predictions, since its effect on the position grows with the square of the length.
pub(super) fn innovations(
    predictor: &Predictor,
    series: &[Series],
    horizon_s: f64,
    half_width_s: f64,
) -> Vec<Innovation> {
    let period_s = series
        .iter()
        .map(|s| median_period(&s.time))
        .fold(0.0, f64::max);
    let bases: Vec<usize> = series
        .iter()
        .scan(0, |next, s| {
            let base = *next;
            *next += s.windows.len();
            Some(base)
        })
        .collect();
    let shortest_s = SHORTEST_S.max(FEWEST_SAMPLES * period_s);
    let mut clearest = (f64::NEG_INFINITY, Vec::new());
    for scale in 0.. {
        let length_s = shortest_s * GROWTH.powi(scale);
        let hidden = clearest.0 <= LEAST_CLEAR;
        if scale > 0 && (length_s > horizon_s || (scale >= SCALES && !hidden)) {
            break;
        }
        let all: Vec<Innovation> = series
            .par_iter()
            .zip(&bases)
            .flat_map_iter(|(s, base)| of_series(predictor, s, *base, length_s, half_width_s))
            .collect();
        let excess: f64 = all.iter().map(|i| i.excess).sum();
        let samples: f64 = all.iter().map(|i| i.samples).sum();
        let clear = excess / (excess + samples);
        if clear > clearest.0 {
            clearest = (clear, all);
        }
        if clear > CLEAR_SHARE {
            break;
        }
    }
    let (clear, all) = clearest;
    if clear > LEAST_CLEAR { all } else { Vec::new() }
}

/// Innovations of `length_s` each, in two sequences that overlap by half.
fn of_series(
    predictor: &Predictor,
    series: &Series,
    base: usize,
    length_s: f64,
    half_width_s: f64,
) -> Vec<Innovation> {
    let half_width_s = half_width_s.max(0.25 * length_s);
    let mut all = Vec::new();
    for delay_s in [0.0, 0.5 * length_s] {
        let short = Series {
            windows: windows(series, delay_s, length_s, half_width_s),
            ..series.clone()
        };
        let predicted = predictor.predict(&short);
        let whitenings = whitenings(predictor, &short, &predicted, 0.0, |_| true);
        for (window, whitening) in short.windows.iter().zip(whitenings.iter().flatten()) {
            let rows = window.samples.clone();
            let mut residual: Vec<f64> = rows
                .clone()
                .map(|i| series.position[i] - predicted[i])
                .collect();
            let since = |i: usize| series.time[i] - window.restart.time_s;
            let mut parabola: Vec<f64> = rows.clone().map(|i| 0.5 * since(i).powi(2)).collect();
            whitening.apply(&mut residual);
            whitening.apply(&mut parabola);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let n = rows.len() as f64;
            let cost = dot(&residual, &residual);
            let size = dot(&parabola, &parabola).sqrt();
            let mean = |column: &[f64]| column[rows.clone()].iter().sum::<f64>() / n;
            let half = rows.start + rows.len() / 2;
            let part = |rows: core::ops::Range<usize>| {
                series.input[rows.clone()].iter().sum::<f64>() / rows.len().max(1) as f64
            };
            let [velocity, acceleration] =
                slopes(&series.time[rows.clone()], &series.position[rows.clone()]);
            if !cost.is_finite() {
                continue;
            }
            all.push(Innovation {
                window: base
                    + series
                        .windows
                        .partition_point(|w| w.samples.end <= rows.start),
                run: series.run,
                session_s: mean(&series.time) + series.session_offset_s,
                position: mean(&series.position),
                velocity,
                slowest: velocity,
                acceleration,
                input: mean(&series.input),
                input_peak: peak(&series.input[rows.clone()]),
                input_change: part(half..rows.end) - part(rows.start..half),
                position_reach: reach(&series.position[rows.clone()]),
                velocity_reach: 0.5 * length_s * acceleration.abs(),
                input_reach: reach(&series.input[rows.clone()]),
                samples: n,
                excess: if cost > NOISE_DOUBT * n + NOISE_MARGIN * (2.0 * n).sqrt() {
                    cost - n
                } else {
                    0.0
                },
                missing: if size > 0.0 {
                    dot(&residual, &parabola) / size
                } else {
                    0.0
                },
            });
        }
    }
    all.sort_by(|a, b| a.session_s.total_cmp(&b.session_s));
    let slowest = slowest(&all);
    for (innovation, slowest) in all.iter_mut().zip(slowest) {
        innovation.slowest = slowest;
    }
    all
}

/// The value of the largest magnitude.
fn peak(column: &[f64]) -> f64 {
    let farther = |a: f64, b: &f64| if b.abs() > a.abs() { *b } else { a };
    column.iter().fold(0.0, farther)
}

/// Half the range of the values.
fn reach(column: &[f64]) -> f64 {
    let lowest = column.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    0.5 * (highest - lowest)
}

/// For each of consecutive innovations, the velocity of the smallest magnitude among it and the [`BEFORE`] preceding ones, or 0 if the
/// sign of the velocity changed.
fn slowest(all: &[Innovation]) -> Vec<f64> {
    let velocities = (0..all.len()).map(|i| {
        let recent = &all[i.saturating_sub(BEFORE)..=i];
        if recent.iter().any(|r| r.velocity * all[i].velocity <= 0.0) {
            return 0.0;
        }
        let recent = recent.iter().map(|r| r.velocity);
        recent.fold(all[i].velocity, |least, v| {
            if v.abs() < least.abs() { v } else { least }
        })
    });
    velocities.collect()
}

fn windows(series: &Series, delay_s: f64, length_s: f64, half_width_s: f64) -> Vec<Window> {
    let Some(&start_s) = series.time.first() else {
        return Vec::new();
    };
    let mut all = Vec::new();
    let mut within = series.windows.iter().peekable();
    let mut first = series.time.partition_point(|&t| t < start_s + delay_s);
    while first < series.time.len() {
        let from_s = series.time[first];
        let last = series
            .time
            .partition_point(|&t| t < from_s + length_s * (1.0 - 1e-9));
        while within.peek().is_some_and(|w| w.samples.end <= first) {
            within.next();
        }
        if let (Some(around), Some(restart)) = (
            within.peek(),
            Restart::fit(&series.time, &series.position, from_s, half_width_s),
        ) {
            all.push(Window {
                samples: first..last,
                restart: restart.correlated(&series.time, series.correlation),
                noise: around.noise,
                restart_noise: around.noise,
            });
        }
        first = last;
    }
    all
}

/// Mean slope and curvature of a parabola that is fitted by least squares.
fn slopes(time: &[f64], position: &[f64]) -> [f64; 2] {
    let n = time.len() as f64;
    let mean_t = time.iter().sum::<f64>() / n;
    let mean_x = position.iter().sum::<f64>() / n;
    let moment = |k: i32| time.iter().map(|t| (t - mean_t).powi(k)).sum::<f64>();
    let product = |k: i32| {
        let pairs = time.iter().zip(position);
        pairs
            .map(|(t, x)| (t - mean_t).powi(k) * (x - mean_x))
            .sum::<f64>()
    };
    let (m2, m3, m4) = (moment(2), moment(3), moment(4));
    let (p1, p2) = (product(1), product(2));
    let spread = m4 - m2 * m2 / n;
    let determinant = m2 * spread - m3 * m3;
    if determinant > 0.0 {
        let slope = (p1 * spread - m3 * p2) / determinant;
        [slope, 2.0 * (m2 * p2 - m3 * p1) / determinant]
    } else if m2 > 0.0 {
        [p1 / m2, 0.0]
    } else {
        [0.0, 0.0]
    }
}
