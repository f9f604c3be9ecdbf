//! Gain and phase margin of a loop.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Distance of a loop from instability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Gain margin: factor by which the loop gain may increase, in decibels. It is infinite if the loop is stable at any
    /// gain.
    pub gain_db: f64,
    /// Phase margin: smallest phase loss that makes the loop unstable, at unity loop gain, degrees. It is negative for an
    /// unstable loop.
    pub phase_deg: f64,
    /// Highest frequency at which the loop gain is 1, Hz.
    pub crossover_hz: f64,
}

impl Margins {
    /// The margins of the open loop `L` at ascending frequencies. The closed loop is `L / (1 + L)`. Returns `None` if the
    /// loop gain is never 1.
    pub fn of(omega_rad_s: &[f64], open: impl Iterator<Item = Complex64>) -> Option<Self> {
        let mut unwrapped = f64::NAN;
        // Each point has the logarithm of the frequency, the logarithm of the gain, and the phase.
        let points: Vec<[f64; 3]> = omega_rad_s
            .iter()
            .zip(open)
            .map(|(omega, value)| {
                let phase = value.arg();
                unwrapped = match unwrapped.is_nan() {
                    // The first phase is between −360° and 0°, as in a loop that holds the position at low frequency.
                    true => phase - TAU * (phase / TAU).ceil(),
                    false => phase + TAU * ((unwrapped - phase) / TAU).round(),
                };
                [omega.ln(), value.norm().ln(), unwrapped]
            })
            .collect();
        let crossing = |pair: &[[f64; 3]], of: usize, level: f64| {
            let [before, after] = [pair[0][of] - level, pair[1][of] - level];
            (before > 0.0 && after <= 0.0 || before <= 0.0 && after > 0.0).then(|| {
                let share = before / (before - after);
                std::array::from_fn::<f64, 3, _>(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]))
            })
        };
        let unity: Vec<_> = points
            .windows(2)
            .filter_map(|pair| crossing(pair, 1, 0.0))
            .collect();
        let last = unity.last()?;
        let phase = unity
            .iter()
            .map(|point| point[2] + PI)
            .fold(f64::INFINITY, f64::min);
        let gain = points
            .windows(2)
            .filter_map(|pair| crossing(pair, 2, -PI))
            .filter(|point| phase < 0.0 || point[0] > last[0])
            .map(|point| -point[1])
            .fold(f64::INFINITY, f64::min);
        Some(Self {
            gain_db: 20.0 * gain / std::f64::consts::LN_10,
            phase_deg: phase.to_degrees(),
            crossover_hz: last[0].exp() / TAU,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Vec<f64> {
        (0..400)
            .map(|i| 0.1 * 10f64.powf(f64::from(i) / 100.0))
            .collect()
    }

    #[test]
    fn the_margins_of_a_triple_lag_agree_with_the_closed_form() {
        // The loop is 4 / (s + 1)³. Its phase is −180° at ω = √3, where its gain is 1/2. Its gain is 1 at ω = √(4^(2/3) −
        // 1), where its phase is −3 atan ω.
        let omega = grid();
        let open = omega.iter().map(|w| 4.0 / Complex64::new(1.0, *w).powi(3));
        let margins = Margins::of(&omega, open).unwrap();
        assert!((margins.gain_db - 6.02).abs() < 0.02, "{margins:?}");
        let crossover = (4f64.powf(2.0 / 3.0) - 1.0).sqrt();
        let phase_deg = 180.0 - 3.0 * crossover.atan().to_degrees();
        assert!((margins.phase_deg - phase_deg).abs() < 0.1, "{margins:?}");
        assert!((margins.crossover_hz * TAU / crossover - 1.0).abs() < 1e-3);
    }

    #[test]
    fn too_much_gain_makes_both_negative() {
        let omega = grid();
        let open = omega.iter().map(|w| 16.0 / Complex64::new(1.0, *w).powi(3));
        let margins = Margins::of(&omega, open).unwrap();
        assert!((margins.gain_db + 6.02).abs() < 0.02 && margins.phase_deg < 0.0);
        let open = omega.iter().map(|w| 0.5 / Complex64::new(1.0, *w).powi(3));
        assert_eq!(Margins::of(&omega, open), None);
    }
}
