//! The gap over frequency: the acceleration that the predictions miss against that of the motion.

use super::bins::Point;
use crate::windows::series::Series;
use core::f64::consts::{PI, TAU};

/// Frequencies looked at, equidistant on a logarithmic scale.
const FREQUENCIES: usize = 40;
/// Highest one, as a share of the sampling rate: above, the noise of a second derivative drowns all.
const HIGHEST: f64 = 0.1;
/// Share of the weight that follows the motion's power; the rest is the same for all frequencies, so that
/// none where nothing moves outweighs the others.
const MOVED_SHARE: f64 = 0.5;
/// Fewest samples of a window that has a spectrum.
const FEWEST_SAMPLES: usize = 8;
/// A power counts from this multiple of the noise's mean power on; noise alone exceeds it once in 150 times.
const CLEAR: f64 = 5.0;
/// Mean square of Hann's window.
const HANN_POWER: f64 = 0.375;

/// Power of the missing acceleration beyond what noise gives, by window and frequency, weighted by the
/// power of the measured acceleration.
pub(super) fn points(
    series: &[Series],
    predictions: &[Vec<f64>],
    horizon_s: f64,
    period_s: f64,
) -> Vec<Point> {
    let (lowest, highest) = (1.0 / horizon_s, HIGHEST / period_s);
    if highest <= lowest {
        return Vec::new();
    }
    let step = (highest / lowest).powf(1.0 / (FREQUENCIES - 1) as f64);
    let frequencies: Vec<f64> = (0..FREQUENCIES)
        .map(|k| lowest * step.powi(k as i32))
        .collect();
    let mut points = Vec::new();
    let mut moved = vec![0.0; FREQUENCIES];
    let mut block = 0;
    for (series, predicted) in series.iter().zip(predictions) {
        for window in &series.windows {
            let rows = window.samples.clone();
            block += 1;
            if rows.len() < FEWEST_SAMPLES {
                continue;
            }
            let time = &series.time[rows.clone()];
            let position = &series.position[rows.clone()];
            let residual: Vec<f64> = position
                .iter()
                .zip(&predicted[rows])
                .map(|(m, p)| m - p)
                .collect();
            let noise = window.noise.powi(2) * time.len() as f64 * HANN_POWER;
            let (residual, position) = (tapered(&residual), tapered(position));
            for (&hz, moved) in frequencies.iter().zip(&mut moved) {
                let [missed, of_motion] = powers(time, [&residual, &position], hz);
                // Twice derived; on a logarithmic scale each line stands for a band as wide as its frequency.
                let scale = (TAU * hz).powi(4) * hz;
                *moved += of_motion * scale;
                points.push(Point {
                    at: hz,
                    block: block - 1,
                    excess: if missed > CLEAR * noise {
                        (missed - noise) * scale
                    } else {
                        0.0
                    },
                    ..Point::default()
                });
            }
        }
    }
    let total: f64 = moved.iter().sum();
    for (point, moved) in points.iter_mut().zip(moved.iter().cycle()) {
        let even = 1.0 / FREQUENCIES as f64;
        point.weight =
            MOVED_SHARE * moved / total.max(f64::MIN_POSITIVE) + (1.0 - MOVED_SHARE) * even;
    }
    points
}

/// A record freed of its straight part and weighted by Hann's window.
fn tapered(x: &[f64]) -> Vec<f64> {
    let n = x.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = x.iter().sum::<f64>() / n;
    let lever = x.iter().enumerate().map(|(i, x)| (i as f64 - middle) * x);
    let slope = lever.sum::<f64>() / (n * (n * n - 1.0) / 12.0);
    let weighted = x.iter().enumerate().map(|(i, x)| {
        let straight = mean + slope * (i as f64 - middle);
        (PI * (i as f64 + 0.5) / n).sin().powi(2) * (x - straight)
    });
    weighted.collect()
}

/// Power of each record at one frequency.
fn powers(time: &[f64], records: [&[f64]; 2], hz: f64) -> [f64; 2] {
    let mut sums = [[0.0; 2]; 2];
    for (i, t) in time.iter().enumerate() {
        let (sin, cos) = (TAU * hz * (t - time[0])).sin_cos();
        for (sum, record) in sums.iter_mut().zip(records) {
            *sum = [sum[0] + record[i] * cos, sum[1] + record[i] * sin];
        }
    }
    sums.map(|[re, im]| re * re + im * im)
}
