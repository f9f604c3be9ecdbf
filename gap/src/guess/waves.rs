//! Fits sine waves over the position for a series of wave numbers.

use core::f64::consts::TAU;

/// Number of wave numbers that are tried.
const GRID: usize = 600;
/// Largest and least number of instants that are used.
const MOST_MOMENTS: usize = 6000;
const FEWEST_MOMENTS: usize = 60;

/// Sines and cosines at given positions, for a wave number that increases in equal steps. Each step rotates the angles, so it needs no
/// trigonometric function.
pub(crate) struct Waves {
    /// Sine and cosine at each position.
    current: Vec<[f64; 2]>,
    step: Vec<[f64; 2]>,
}

impl Waves {
    /// Starts with the wave number `first`.
    pub(crate) fn of(positions: &[f64], first: f64, step: f64) -> Self {
        let waves = |n: f64| {
            let waves = positions.iter().map(|x| (n * x).sin_cos().into());
            waves.collect()
        };
        Self {
            current: waves(first),
            step: waves(step),
        }
    }

    /// Sine and cosine at each position.
    pub(crate) fn current(&self) -> &[[f64; 2]] {
        &self.current
    }

    /// Advances to the next wave number.
    pub(crate) fn advance(&mut self) {
        for ([sin, cos], [by_sin, by_cos]) in self.current.iter_mut().zip(&self.step) {
            (*sin, *cos) = (*sin * by_cos + *cos * by_sin, *cos * by_cos - *sin * by_sin);
        }
    }
}

/// Highest wave number, from `lowest` on, for which the steps of [`strongest`] are fine enough to resolve waves over `span`.
pub(crate) fn highest_resolved(lowest: f64, span: f64) -> f64 {
    lowest + GRID as f64 * TAU / span
}

/// The wave numbers in a range whose sine and cosine have local maxima of the amplitude, strongest first, with both amplitudes. Each
/// moment is a position, a direction and a value. The mean value of each direction is subtracted before.
pub(crate) fn strongest(
    mut moments: Vec<(f64, bool, f64)>,
    [lowest, highest]: [f64; 2],
    span: f64,
) -> Vec<(f64, [f64; 2])> {
    if moments.len() < FEWEST_MOMENTS || highest <= lowest {
        return Vec::new();
    }
    // The mean in each direction belongs to other effects.
    for forward in [true, false] {
        let in_direction = || moments.iter().filter(|m| m.1 == forward);
        let mean = in_direction().map(|m| m.2).sum::<f64>() / in_direction().count().max(1) as f64;
        for moment in moments.iter_mut().filter(|m| m.1 == forward) {
            moment.2 -= mean;
        }
    }
    // The resolution is 2π over the span. Over many revolutions [`GRID`] wave numbers suffice.
    let step = ((highest - lowest) / GRID as f64).max(0.25 * TAU / span);
    let count = ((highest - lowest) / step) as usize + 1;
    let stride = (moments.len() / MOST_MOMENTS).max(1);
    let some: Vec<(f64, bool, f64)> = moments.into_iter().step_by(stride).collect();
    let positions: Vec<f64> = some.iter().map(|m| m.0).collect();
    let mut waves = Waves::of(&positions, lowest, step);
    let grid: Vec<[f64; 2]> = (0..count)
        .map(|_| {
            let (mut a, mut b) = (0.0, 0.0);
            for ((.., value), [sin, cos]) in some.iter().zip(waves.current()) {
                a += value * sin;
                b += value * cos;
            }
            waves.advance();
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
    fn rotated_waves_agree_with_direct_sines() {
        let positions = [-3.0, 0.0, 0.7, 250.0];
        let mut waves = Waves::of(&positions, 1.5, 0.25);
        for i in 0..1000 {
            let n = 1.5 + 0.25 * f64::from(i);
            for (x, [sin, cos]) in positions.iter().zip(waves.current()) {
                assert!((sin - (n * x).sin()).abs() < 1e-9);
                assert!((cos - (n * x).cos()).abs() < 1e-9);
            }
            waves.advance();
        }
    }
}
