//! The measured state at an instant: value and slope of a cubic that is fitted to the samples around it.

use nalgebra::{Matrix4, Vector4};

/// Least number of samples of a fit, if the run has as many.
pub(crate) const FEWEST: usize = 9;
/// Number of coefficients of a cubic.
const CUBIC: usize = 4;

/// A cubic fitted by least squares around an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// The instant, in the time of the run, s.
    pub time_s: f64,
    /// Position at the instant, in position units.
    pub value: f64,
    /// Velocity at the instant, in position units per s.
    pub slope: f64,
    /// Acceleration at the instant, in position units per s².
    pub curvature: f64,
    /// Covariance of position and velocity for noise of unit variance. The noise is white unless [`correlated`](Self::correlated) was
    /// called.
    pub covariance: [[f64; 2]; 2],
    /// Sum of squared residuals.
    pub residual: f64,
    /// Degrees of freedom: the expected sum of squared residuals for noise of unit variance.
    pub freedom: f64,
    /// Sum of the products of consecutive residuals.
    pub neighbours: f64,
    /// Index of the first sample of the fit, and of the sample after the last.
    pub samples: [usize; 2],
    /// Inverse normal matrix and time scale, for [`correlated`](Self::correlated).
    inverse: Matrix4<f64>,
    scale_s: f64,
}

impl Restart {
    /// Replaces the state at the instant by a position, a velocity and an acceleration.
    pub(crate) fn at(self, [value, slope, curvature]: [f64; 3]) -> Self {
        Self {
            value,
            slope,
            curvature,
            ..self
        }
    }

    /// Draws errors of position and velocity for noise of a given standard deviation. `drawn` returns a random number of a given standard
    /// deviation.
    pub(crate) fn errors(&self, noise: f64, mut drawn: impl FnMut(f64) -> f64) -> [f64; 2] {
        let [[value, both], [_, slope]] = self.covariance;
        let value = value.max(f64::MIN_POSITIVE);
        let first = drawn(noise * value.sqrt());
        let alone = (slope - both * both / value).max(0.0).sqrt();
        [first, both / value * first + drawn(noise * alone)]
    }

    /// Fits the samples within ± `half_width_s` of `time_s`, or the nearest nine samples if fewer lie within. Returns `None` if the run
    /// has fewer than four samples.
    pub fn fit(time: &[f64], position: &[f64], time_s: f64, half_width_s: f64) -> Option<Self> {
        let [first, last] = around(time, time_s, half_width_s);
        if last - first < CUBIC {
            return None;
        }
        let scale_s = (time[last - 1] - time_s)
            .abs()
            .max((time_s - time[first]).abs());
        // Positions are relative to the first one, so that a large offset costs no precision.
        let base = position[first];
        let mut normal = Matrix4::zeros();
        let mut right = Vector4::zeros();
        for i in first..last {
            let row = powers((time[i] - time_s) / scale_s);
            normal += row * row.transpose();
            right += row * (position[i] - base);
        }
        let inverse = normal.try_inverse()?;
        let c = inverse * right;
        let (mut residual, mut neighbours, mut before) = (0.0, 0.0, 0.0);
        for i in first..last {
            let fitted = powers((time[i] - time_s) / scale_s).dot(&c);
            let left = position[i] - base - fitted;
            residual += left * left;
            neighbours += left * before;
            before = left;
        }
        Some(Self {
            time_s,
            value: base + c[0],
            slope: c[1] / scale_s,
            curvature: 2.0 * c[2] / (scale_s * scale_s),
            covariance: unscaled(&inverse, scale_s),
            residual,
            freedom: (last - first - CUBIC) as f64,
            neighbours,
            samples: [first, last],
            inverse,
            scale_s,
        })
    }

    /// Adjusts the covariance and the degrees of freedom for noise of a first-order autoregressive process. `time` holds the times of the
    /// run, and `correlation` is that of consecutive samples.
    pub fn correlated(mut self, time: &[f64], correlation: f64) -> Self {
        if correlation == 0.0 {
            return self;
        }
        let [first, last] = self.samples;
        let (mut covariance, mut shared) = (self.inverse, 0.0);
        let mut earlier = Vector4::zeros();
        for &t in &time[first..last] {
            let row = powers((t - self.time_s) / self.scale_s);
            let weights = self.inverse * row;
            covariance += weights * earlier.transpose() + earlier * weights.transpose();
            shared += 2.0 * row.dot(&earlier);
            earlier = correlation * (earlier + weights);
        }
        self.covariance = unscaled(&covariance, self.scale_s);
        self.freedom = (last - first - CUBIC) as f64 - shared;
        self
    }
}

/// Covariance of position and velocity from that of the scaled coefficients of a cubic.
fn unscaled(covariance: &Matrix4<f64>, scale_s: f64) -> [[f64; 2]; 2] {
    let off = covariance[(0, 1)] / scale_s;
    let slope = covariance[(1, 1)] / (scale_s * scale_s);
    [[covariance[(0, 0)], off], [off, slope]]
}

fn powers(x: f64) -> Vector4<f64> {
    Vector4::new(1.0, x, x * x, x * x * x)
}

/// Indices of the samples within ± `half_width_s` of `time_s`, extended to the nearest [`FEWEST`].
fn around(time: &[f64], time_s: f64, half_width_s: f64) -> [usize; 2] {
    // A margin against rounding includes a sample exactly on the edge.
    let half = half_width_s * (1.0 + 1e-9) + 4.0 * f64::EPSILON * time_s.abs();
    let mut first = time.partition_point(|&t| t < time_s - half);
    let mut last = time.partition_point(|&t| t <= time_s + half);
    while last - first < FEWEST.min(time.len()) {
        let before = first.checked_sub(1).map(|i| time_s - time[i]);
        let after = time.get(last).map(|&t| t - time_s);
        match (before, after) {
            (Some(b), Some(a)) if b <= a => first -= 1,
            (Some(_), None) => first -= 1,
            (_, Some(_)) => last += 1,
            (None, None) => break,
        }
    }
    [first, last]
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::sensors::Noise;

    fn times(n: usize) -> Vec<f64> {
        (0..n).map(|i| 100.0 + i as f64 * 1e-3).collect()
    }

    #[test]
    fn a_cubic_is_found_exactly() {
        let time = times(100);
        let at = |t: f64| 5.0 + 2.0 * (t - 100.05) - 30.0 * (t - 100.05).powi(2);
        let position: Vec<f64> = time.iter().map(|&t| at(t)).collect();
        let fit = Restart::fit(&time, &position, 100.05, 0.008).unwrap();
        assert_eq!(fit.samples[1] - fit.samples[0], 17);
        assert!((fit.value - 5.0).abs() < 1e-9);
        assert!((fit.slope - 2.0).abs() < 1e-6);
        assert!((fit.curvature + 60.0).abs() < 1e-2);
    }

    #[test]
    fn a_fit_at_either_end_of_a_run_has_nine_samples() {
        let time = times(100);
        let position = vec![1.0; 100];
        let start = Restart::fit(&time, &position, 100.0, 0.001).unwrap();
        assert_eq!(start.samples, [0, 9]);
        let end = Restart::fit(&time, &position, 100.099, 0.001).unwrap();
        assert_eq!(end.samples, [91, 100]);
    }

    #[test]
    fn covariance_and_freedom_are_right_for_low_passed_noise() {
        let time = times(100);
        let correlation: f64 = 0.8;
        let mut noise = Noise::new(1);
        let (mut slopes, mut residuals, mut freedom) = (0.0, 0.0, 0.0);
        let mut expected = 0.0;
        let count = 4000;
        for _ in 0..count {
            let mut left = noise.next(1.0);
            let position: Vec<f64> = time
                .iter()
                .map(|_| {
                    let new = noise.next((1.0 - correlation * correlation).sqrt());
                    left = correlation * left + new;
                    left
                })
                .collect();
            let fit = Restart::fit(&time, &position, 100.05, 0.008).unwrap();
            let fit = fit.correlated(&time, correlation);
            slopes += fit.slope.powi(2) / f64::from(count);
            residuals += fit.residual / f64::from(count);
            (expected, freedom) = (fit.covariance[1][1], fit.freedom);
        }
        assert!((slopes / expected - 1.0).abs() < 0.1, "{slopes} {expected}");
        assert!(
            (residuals / freedom - 1.0).abs() < 0.1,
            "{residuals} {freedom}"
        );
    }
}
