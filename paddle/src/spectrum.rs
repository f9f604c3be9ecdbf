//! Spectrum of a signal by Welch's method.

use std::f64::consts::TAU;

/// One-sided amplitude density, in the unit of the signal per root hertz, over frequency in Hz, without the mean. The method
/// averages Hann windows of `length` samples that overlap by half (P. D. Welch, IEEE Transactions on Audio and
/// Electroacoustics 15, 1967). The result is empty if the signal is shorter than one window.
pub fn amplitude_density(signal: &[f64], sample_hz: f64, length: usize) -> Vec<(f64, f64)> {
    let window: Vec<_> = (0..length)
        .map(|i| 0.5 - 0.5 * (TAU * i as f64 / length as f64).cos())
        .collect();
    let windows_power: f64 = window.iter().map(|w| w * w).sum();
    let segments: Vec<Vec<f64>> = (0..)
        .map(|i| i * length / 2)
        .map_while(|from| signal.get(from..from + length))
        .map(|segment| {
            let mean = segment.iter().sum::<f64>() / length as f64;
            segment
                .iter()
                .zip(&window)
                .map(|(x, w)| (x - mean) * w)
                .collect()
        })
        .collect();
    if segments.is_empty() {
        return Vec::new();
    }
    (1..length / 2)
        .map(|bin| {
            let power: f64 = segments.iter().map(|segment| power_at(segment, bin)).sum();
            let density = 2.0 * power / (segments.len() as f64 * windows_power * sample_hz);
            (bin as f64 * sample_hz / length as f64, density.sqrt())
        })
        .collect()
}

/// Squared magnitude of one bin of the discrete Fourier transform (G. Goertzel, American Mathematical Monthly 65, 1958).
fn power_at(segment: &[f64], bin: usize) -> f64 {
    let coefficient = 2.0 * (TAU * bin as f64 / segment.len() as f64).cos();
    let (last, before) = segment.iter().fold((0.0, 0.0), |(last, before), x| {
        (x + coefficient * last - before, last)
    });
    last * last + before * before - coefficient * last * before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_the_density_is_the_variance() {
        let signal: Vec<_> = (0..4096)
            .map(|i| 3.0 + 2f64.sqrt() * (TAU * 50.3 * f64::from(i) / 1000.0).sin())
            .collect();
        let density = amplitude_density(&signal, 1000.0, 512);
        let step = density[1].0 - density[0].0;
        let variance: f64 = density.iter().map(|(_, d)| d * d * step).sum();
        assert!((variance - 1.0).abs() < 0.02, "{variance}");
        let peak = density.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((peak.0 - 50.3).abs() < step);
    }
}
