//! The frequency axis: the spectrum of the missing acceleration, compared with the spectra of the acceleration and of the input.

use super::bins::Point;
use super::innovation::Innovation;
use crate::windows::series::median_period;
use core::f64::consts::{PI, TAU};

/// Number of frequencies, equidistant on a logarithmic scale.
const FREQUENCIES: usize = 40;
/// Number of consecutive innovations in one segment. Each segment yields one spectrum.
const SEGMENT: usize = 64;
/// Least number of periods of the lowest frequency in a segment. With fewer periods the lines leak into each other under a Hann window.
const FEWEST_PERIODS: f64 = 2.0;
/// A segment contains no gap in time longer than this many steps.
const LONGEST_STEP: f64 = 1.5;
/// Share of the weight that is proportional to the power of the acceleration, and to that of the input. The rest is equal for all bands,
/// so that a frequency without motion does not stand out.
const MOVED_SHARE: f64 = 0.25;

/// Power of the `missing` values by segment and frequency. There is one missing value for each innovation, in the order of time. The
/// weights follow the powers of acceleration and input.
pub(super) fn points(all: &[Innovation], missing: &[f64]) -> Vec<Point> {
    let times: Vec<f64> = all.iter().map(|i| i.session_s).collect();
    let step_s = median_period(&times);
    let frequencies = frequencies(step_s);
    let mut points = Vec::new();
    let mut moved = [[0.0; 2]; FREQUENCIES];
    for (block, from) in segments(all, step_s).into_iter().enumerate() {
        let segment = from..from + SEGMENT;
        let time = &times[segment.clone()];
        let of = |value: &dyn Fn(usize) -> f64| tapered(segment.clone().map(value).collect());
        let records = [
            of(&|i| missing[i]),
            of(&|i| all[i].acceleration),
            of(&|i| all[i].input),
        ];
        for (&hz, moved) in frequencies.iter().zip(&mut moved) {
            // On a logarithmic scale each line represents a band whose width is proportional to its frequency.
            let [of_missing, of_motion, of_input] = powers(time, &records, hz).map(|p| p * hz);
            *moved = [moved[0] + of_motion, moved[1] + of_input];
            points.push(Point {
                at: hz,
                block,
                excess: of_missing,
                ..Point::default()
            });
        }
    }
    let weights = weights(&frequencies, &moved);
    for (point, weight) in points.iter_mut().zip(weights.iter().cycle()) {
        point.weight = *weight;
    }
    points
}

/// The frequencies, Hz. The lowest has [`FEWEST_PERIODS`] periods in a segment; the highest is half the rate of the innovations.
fn frequencies(step_s: f64) -> [f64; FREQUENCIES] {
    let lowest = FEWEST_PERIODS / (SEGMENT as f64 * step_s);
    let highest = 0.5 / step_s;
    let ratio = (highest / lowest).powf(1.0 / (FREQUENCIES - 1) as f64);
    core::array::from_fn(|k| lowest * ratio.powi(k as i32))
}

/// Index at which each segment begins. Consecutive segments overlap by half.
fn segments(all: &[Innovation], step_s: f64) -> Vec<usize> {
    let follows = |a: &Innovation, b: &Innovation| {
        a.run == b.run && b.session_s - a.session_s <= LONGEST_STEP * step_s
    };
    let mut segments = Vec::new();
    let mut first = 0;
    for piece in all.chunk_by(follows) {
        let end = first + piece.len();
        segments.extend((first..(end + 1).saturating_sub(SEGMENT)).step_by(SEGMENT / 2));
        first = end;
    }
    segments
}

/// Weight of each frequency, from the powers of acceleration and input.
fn weights(
    frequencies: &[f64; FREQUENCIES],
    moved: &[[f64; 2]; FREQUENCIES],
) -> [f64; FREQUENCIES] {
    let total_frequency: f64 = frequencies.iter().sum();
    let total = moved.iter().fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    core::array::from_fn(|k| {
        let shares = [0, 1].map(|of| moved[k][of] / total[of].max(f64::MIN_POSITIVE));
        MOVED_SHARE * (shares[0] + shares[1])
            + (1.0 - 2.0 * MOVED_SHARE) * frequencies[k] / total_frequency
    })
}

/// Subtracts the mean of a record and applies a Hann window.
fn tapered(mut record: Vec<f64>) -> Vec<f64> {
    let n = record.len() as f64;
    let mean = record.iter().sum::<f64>() / n;
    for (i, x) in record.iter_mut().enumerate() {
        *x = (PI * (i as f64 + 0.5) / n).sin().powi(2) * (*x - mean);
    }
    record
}

/// Power of each record at one frequency.
fn powers(time: &[f64], records: &[Vec<f64>; 3], hz: f64) -> [f64; 3] {
    let mut sums = [[0.0; 2]; 3];
    for (i, t) in time.iter().enumerate() {
        let (sin, cos) = (TAU * hz * (t - time[0])).sin_cos();
        for (sum, record) in sums.iter_mut().zip(records) {
            *sum = [sum[0] + record[i] * cos, sum[1] + record[i] * sin];
        }
    }
    sums.map(|[re, im]| re * re + im * im)
}

#[cfg(test)]
mod tests {
    use super::super::bins::Bins;
    use super::*;

    /// Innovations every 10 ms, in two runs.
    fn all(count: usize) -> Vec<Innovation> {
        let innovation = |i: usize| Innovation {
            run: usize::from(i >= count / 2),
            session_s: 0.01 * i as f64,
            acceleration: if i % 20 < 10 { 1.0 } else { -1.0 },
            ..Innovation::default()
        };
        (0..count).map(innovation).collect()
    }

    #[test]
    fn a_resonance_is_located_in_its_band() {
        let all = all(600);
        let missing: Vec<f64> = all
            .iter()
            .map(|i| (TAU * 12.0 * i.session_s).sin() + 0.3 * i.acceleration)
            .collect();
        let bins = Bins::new(points(&all, &missing), FREQUENCIES).unwrap();
        let band = bins.best(None).unwrap();
        assert!(band.from > 8.0 && band.from < 12.0, "{band:?}");
        assert!(band.to > 12.0 && band.to < 16.0, "{band:?}");
        assert!(band.surplus() > 0.6, "{band:?}");
    }

    #[test]
    fn no_segment_spans_two_runs() {
        let all = all(2 * (SEGMENT + SEGMENT / 2));
        let run = SEGMENT + SEGMENT / 2;
        assert_eq!(
            segments(&all, 0.01),
            [0, SEGMENT / 2, run, run + SEGMENT / 2]
        );
        assert!(points(&all[..SEGMENT - 1], &vec![1.0; SEGMENT - 1]).is_empty());
        assert!(points(&[], &[]).is_empty());
    }
}
