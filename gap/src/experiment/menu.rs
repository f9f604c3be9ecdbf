//! The excitations of the firmware that are tried.

use haptic_paddle::excitation::{Excitation, Shape};

/// Amplitudes, as shares of the largest input.
const AMPLITUDES: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// Frequencies, in periods per horizon.
const FREQUENCIES: [f64; 3] = [0.25, 1.0, 3.0];
/// Length of every excitation, in horizons.
const DURATION: f64 = 8.0;

/// All excitations, for inputs up to `largest_input` and a prediction horizon `horizon_s`.
pub(super) fn excitations(largest_input: f64, horizon_s: f64) -> Vec<Excitation> {
    let duration_s = rounded(DURATION * horizon_s);
    let [slow, .., fast] = FREQUENCIES.map(|f| rounded(f / horizon_s));
    let mut all = Vec::new();
    for amplitude in AMPLITUDES.map(|share| rounded(share * largest_input)) {
        let plain = Excitation {
            duration_s,
            ..Excitation::step(amplitude)
        };
        let of = |shape| Excitation { shape, ..plain };
        all.extend([Shape::Step, Shape::Ramp].map(of));
        all.push(Excitation {
            frequency_hz: slow,
            end_frequency_hz: fast,
            ..of(Shape::Chirp)
        });
        for frequency_hz in FREQUENCIES.map(|f| rounded(f / horizon_s)) {
            let waves = [
                Shape::Sine,
                Shape::Square,
                Shape::Triangle,
                Shape::Multisine,
            ];
            all.extend(waves.map(|shape| Excitation {
                frequency_hz,
                ..of(shape)
            }));
        }
    }
    all
}

/// Rounds to two digits, so that the simulated excitation equals the reported one.
fn rounded(value: f64) -> f32 {
    let text = format!("{value:.1e}");
    text.parse().unwrap_or(value as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_digits() {
        assert_eq!(rounded(0.012_345), 0.012);
        assert_eq!(rounded(6.666_7), 6.7);
        assert_eq!(rounded(0.0), 0.0);
    }

    #[test]
    fn every_shape_of_the_firmware_is_there() {
        let all = excitations(0.02, 0.3);
        for (name, shape) in Shape::NAMED {
            assert!(all.iter().any(|e| e.shape == shape), "{name}");
        }
        assert!(all.iter().all(|e| e.amplitude <= 0.02));
    }
}
