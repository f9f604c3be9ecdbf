//! The gap over frequency: the spectrum of the missing acceleration against those of the motion and the input.

use super::bins::Point;
use super::innovation::Innovation;
use crate::windows::series::median_period;
use core::f64::consts::{PI, TAU};

/// Frequencies looked at, equidistant on a logarithmic scale.
const FREQUENCIES: usize = 40;
/// Innovations in a row that have a spectrum.
const ROW: usize = 64;
/// Waves in a row at the lowest frequency: fewer leak into one another under Hann's window.
const FEWEST_WAVES: f64 = 2.0;
/// A row ends where the next innovation is farther than this many steps.
const LONGEST_STEP: f64 = 1.5;
/// Share of the weight that follows the power of each of acceleration and input; the rest is the same for all frequencies, so that
/// none where nothing moves outweighs the others.
const MOVED_SHARE: f64 = 0.25;

/// Power of what is `missing`, one number for each innovation in the order of time, by row and frequency, weighted by the powers of
/// acceleration and input.
pub(super) fn points(all: &[Innovation], missing: &[f64]) -> Vec<Point> {
    let times: Vec<f64> = all.iter().map(|i| i.session_s).collect();
    let step_s = median_period(&times);
    let frequencies = frequencies(step_s);
    let mut points = Vec::new();
    let mut moved = [[0.0; 2]; FREQUENCIES];
    for (block, from) in rows(all, step_s).into_iter().enumerate() {
        let row = from..from + ROW;
        let time = &times[row.clone()];
        let of = |value: &dyn Fn(usize) -> f64| tapered(row.clone().map(value).collect());
        let records = [
            of(&|i| missing[i]),
            of(&|i| all[i].acceleration),
            of(&|i| all[i].input),
        ];
        for (&hz, moved) in frequencies.iter().zip(&mut moved) {
            // On a logarithmic scale each line stands for a band as wide as its frequency.
            let [missed, of_motion, of_input] = powers(time, &records, hz).map(|p| p * hz);
            *moved = [moved[0] + of_motion, moved[1] + of_input];
            points.push(Point {
                at: hz,
                block,
                excess: missed,
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

/// From the lowest of which a row holds enough waves to the highest that innovations tell, Hz.
fn frequencies(step_s: f64) -> [f64; FREQUENCIES] {
    let lowest = FEWEST_WAVES / (ROW as f64 * step_s);
    let highest = 0.5 / step_s;
    let ratio = (highest / lowest).powf(1.0 / (FREQUENCIES - 1) as f64);
    core::array::from_fn(|k| lowest * ratio.powi(k as i32))
}

/// Where each row begins; two in a row overlap by half.
fn rows(all: &[Innovation], step_s: f64) -> Vec<usize> {
    let follows = |a: &Innovation, b: &Innovation| {
        a.run == b.run && b.session_s - a.session_s <= LONGEST_STEP * step_s
    };
    let mut rows = Vec::new();
    let mut first = 0;
    for piece in all.chunk_by(follows) {
        let end = first + piece.len();
        rows.extend((first..(end + 1).saturating_sub(ROW)).step_by(ROW / 2));
        first = end;
    }
    rows
}

/// Weight of each frequency.
fn weights(
    frequencies: &[f64; FREQUENCIES],
    moved: &[[f64; 2]; FREQUENCIES],
) -> [f64; FREQUENCIES] {
    let even: f64 = frequencies.iter().sum();
    let total = moved.iter().fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    core::array::from_fn(|k| {
        let shares = [0, 1].map(|of| moved[k][of] / total[of].max(f64::MIN_POSITIVE));
        MOVED_SHARE * (shares[0] + shares[1]) + (1.0 - 2.0 * MOVED_SHARE) * frequencies[k] / even
    })
}

/// A record freed of its mean and weighted by Hann's window.
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

    /// A step of 10 ms, in two runs.
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
    fn a_resonance_is_told_as_its_band() {
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
    fn no_row_goes_from_one_run_to_the_next() {
        let all = all(2 * (ROW + ROW / 2));
        let run = ROW + ROW / 2;
        assert_eq!(rows(&all, 0.01), [0, ROW / 2, run, run + ROW / 2]);
        assert!(points(&all[..ROW - 1], &vec![1.0; ROW - 1]).is_empty());
        assert!(points(&[], &[]).is_empty());
    }
}
