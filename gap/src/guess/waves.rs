//! Sine waves over position, of one wave number after the other.

use core::f64::consts::TAU;

/// Wave numbers tried.
const GRID: usize = 600;
/// Moments that are looked at for that, at most and at least.
const MOST_MOMENTS: usize = 6000;
const FEWEST_MOMENTS: usize = 60;

/// Sines and cosines at some positions, of a wave number that grows step by step: angles are turned on, which takes no sine.
pub(crate) struct Waves {
    /// By position: sine and cosine.
    now: Vec<[f64; 2]>,
    step: Vec<[f64; 2]>,
}

impl Waves {
    /// Of the wave number `first` at some positions.
    pub(crate) fn of(positions: &[f64], first: f64, step: f64) -> Self {
        let waves = |n: f64| {
            let waves = positions.iter().map(|x| (n * x).sin_cos().into());
            waves.collect()
        };
        Self {
            now: waves(first),
            step: waves(step),
        }
    }

    /// By position: sine and cosine.
    pub(crate) fn now(&self) -> &[[f64; 2]] {
        &self.now
    }

    /// Goes on to the next wave number.
    pub(crate) fn go_on(&mut self) {
        for ([sin, cos], [by_sin, by_cos]) in self.now.iter_mut().zip(&self.step) {
            (*sin, *cos) = (*sin * by_cos + *cos * by_sin, *cos * by_cos - *sin * by_sin);
        }
    }
}

/// Wave number up to which, from `lowest` on, steps are no wider than what tells two waves apart over a span.
pub(crate) fn last_told_apart(lowest: f64, span: f64) -> f64 {
    lowest + GRID as f64 * TAU / span
}

/// The wave numbers in a range of which a sine and a cosine make most of what varies over position in each direction, with
/// their amplitudes, the strongest first: from position, direction and value at each moment.
pub(crate) fn strongest(
    mut moments: Vec<(f64, bool, f64)>,
    [lowest, highest]: [f64; 2],
    span: f64,
) -> Vec<(f64, [f64; 2])> {
    if moments.len() < FEWEST_MOMENTS || highest <= lowest {
        return Vec::new();
    }
    // Slow trends belong to others: the mean in each direction is taken out.
    for forward in [true, false] {
        let mine = || moments.iter().filter(|m| m.1 == forward);
        let mean = mine().map(|m| m.2).sum::<f64>() / mine().count().max(1) as f64;
        for moment in moments.iter_mut().filter(|m| m.1 == forward) {
            moment.2 -= mean;
        }
    }
    // Resolution is 2π over the span; on many turns whole numbers a turn are enough.
    let step = ((highest - lowest) / GRID as f64).max(0.25 * TAU / span);
    let count = ((highest - lowest) / step) as usize + 1;
    let stride = (moments.len() / MOST_MOMENTS).max(1);
    let some: Vec<(f64, bool, f64)> = moments.into_iter().step_by(stride).collect();
    let positions: Vec<f64> = some.iter().map(|m| m.0).collect();
    let mut waves = Waves::of(&positions, lowest, step);
    let grid: Vec<[f64; 2]> = (0..count)
        .map(|_| {
            let (mut a, mut b) = (0.0, 0.0);
            for ((.., value), [sin, cos]) in some.iter().zip(waves.now()) {
                a += value * sin;
                b += value * cos;
            }
            waves.go_on();
            [a, b].map(|sum| 2.0 * sum / some.len() as f64)
        })
        .collect();
    let strength = |i: usize| grid[i][0].hypot(grid[i][1]);
    let mut peaks: Vec<usize> = (0..grid.len())
        .filter(|&i| {
            (i == 0 || strength(i) >= strength(i - 1))
                && (i + 1 == grid.len() || strength(i) > strength(i + 1))
        })
        .collect();
    peaks.sort_by(|&i, &j| strength(j).total_cmp(&strength(i)));
    let peaks = peaks.into_iter();
    peaks.map(|i| (lowest + step * i as f64, grid[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_what_sines_are() {
        let positions = [-3.0, 0.0, 0.7, 250.0];
        let mut waves = Waves::of(&positions, 1.5, 0.25);
        for i in 0..1000 {
            let n = 1.5 + 0.25 * f64::from(i);
            for (x, [sin, cos]) in positions.iter().zip(waves.now()) {
                assert!((sin - (n * x).sin()).abs() < 1e-9);
                assert!((cos - (n * x).cos()).abs() < 1e-9);
            }
            waves.go_on();
        }
    }
}
