//! Estimates the properties of a position sensor from its readings.

use recording::{Sensor, sixth_differences};

/// Least average number of repetitions of a quantised value.
const REPEATS: usize = 4;
/// Least share of distances between neighbouring values on the grid.
const ON_GRID: f64 = 0.9;
/// Largest distance from a grid point, as a share of the quantum, for a value on the grid.
const OFF: f64 = 0.1;
/// Noise below this, relative to the largest value, is rounding of numbers.
const ROUNDING: f64 = 1e-9;
/// Median magnitude of a sixth difference of white noise over its standard deviation.
const MEDIAN_DIFFERENCE: f64 = 20.5;

/// The quantum of the readings, or their noise if they are not quantised.
pub(crate) fn shown(position: &[f64]) -> Sensor {
    if let Some(resolution) = quantum(position) {
        return Sensor {
            resolution,
            ..Sensor::default()
        };
    }
    let mut sizes: Vec<f64> = sixth_differences(position).map(f64::abs).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let noise = sizes
        .get(sizes.len() / 2)
        .map_or(0.0, |median| median / MEDIAN_DIFFERENCE);
    let largest = position
        .iter()
        .fold(0.0_f64, |largest, x| largest.max(x.abs()));
    // Smaller noise is the rounding of the logging program.
    let noise = if noise > ROUNDING * largest {
        three_digits(noise)
    } else {
        0.0
    };
    Sensor {
        noise,
        ..Sensor::default()
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
fn quantum(position: &[f64]) -> Option<f64> {
    let mut values = position.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let span = values.last()? - values.first()?;
    values.dedup_by(|b, a| *b - *a <= 1e-6 * span);
    let mut distances: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let step = *distances.get(distances.len() / 10)?;
    let on_grid = distances
        .iter()
        .filter(|distance| (*distance / step - (*distance / step).round()).abs() < OFF);
    let is_grid = on_grid.count() as f64 >= ON_GRID * distances.len() as f64;
    // The mean of all single steps is more accurate than one of them.
    let single = distances
        .iter()
        .filter(|distance| (*distance / step).round() == 1.0);
    let mean = single.clone().sum::<f64>() / single.count().max(1) as f64;
    (is_grid && values.len() * REPEATS <= position.len()).then(|| three_digits(mean))
}

/// A number rounded to three digits.
pub(crate) fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_shows_its_quantum_and_a_smooth_sensor_its_noise() {
        let motion = |k: i32| 0.5 * (0.01 * f64::from(k)).sin();
        let counted: Vec<f64> = (0..4000)
            .map(|k| (motion(k) / 0.0125).round() * 0.0125)
            .collect();
        assert_eq!(
            shown(&counted),
            Sensor {
                resolution: 0.0125,
                ..Sensor::default()
            }
        );
        // Pseudo-random noise: the fractional parts of multiples of an irrational number.
        let noisy = |k: i32| {
            motion(k) + 1e-3 * ((f64::from(k * k % 9973) * 0.618_033_988_75).fract() - 0.5)
        };
        let noise = shown(&(0..4000).map(noisy).collect::<Vec<_>>()).noise;
        assert!((noise - 2.9e-4).abs() < 1e-4, "{noise}");
    }
}
