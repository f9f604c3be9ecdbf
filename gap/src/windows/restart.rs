//! The measured state at an instant: value and slope of a cubic through the samples around it.

use nalgebra::{Matrix4, Vector4};

/// Fewest samples of a fit.
pub(crate) const FEWEST: usize = 9;
/// Unknowns of a cubic.
const CUBIC: usize = 4;

/// A cubic fitted by least squares around an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// The instant, in the run's time, s.
    pub time_s: f64,
    /// Value there, in units of position.
    pub value: f64,
    /// Slope there, per s.
    pub slope: f64,
    /// Second derivative there, per s².
    pub curvature: f64,
    /// Covariance of value and slope for noise of unit variance, white unless [`correlated`](Self::correlated).
    pub covariance: [[f64; 2]; 2],
    /// Sum of squared residuals.
    pub residual: f64,
    /// Degrees of freedom of the residual: its expected sum of squares for noise of unit variance.
    pub freedom: f64,
    /// Sum of the products of neighbouring residuals.
    pub neighbours: f64,
    /// Samples in the fit: first, and one past the last.
    pub samples: [usize; 2],
    /// Inverse normal matrix and time scale, for [`correlated`](Self::correlated).
    inverse: Matrix4<f64>,
    scale_s: f64,
}

impl Restart {
    /// The same instant in another state: value, slope and second derivative.
    pub(crate) fn at(self, [value, slope, curvature]: [f64; 3]) -> Self {
        Self {
            value,
            slope,
            curvature,
            ..self
        }
    }

    /// Errors of value and slope as noise of this standard deviation makes them, from `drawn` numbers of given ones.
    pub(crate) fn errors(&self, noise: f64, mut drawn: impl FnMut(f64) -> f64) -> [f64; 2] {
        let [[value, both], [_, slope]] = self.covariance;
        let value = value.max(f64::MIN_POSITIVE);
        let first = drawn(noise * value.sqrt());
        let alone = (slope - both * both / value).max(0.0).sqrt();
        [first, both / value * first + drawn(noise * alone)]
    }

    /// Fits the samples within ± `half_width_s` of `time_s`, or the nearest nine if those are fewer.
    /// `None` if the run has fewer than four samples.
    pub fn fit(time: &[f64], position: &[f64], time_s: f64, half_width_s: f64) -> Option<Self> {
        let [first, last] = around(time, time_s, half_width_s);
        if last - first < CUBIC {
            return None;
        }
        let scale_s = (time[last - 1] - time_s)
            .abs()
            .max((time_s - time[first]).abs());
        // Values relative to one of them, so that a large offset costs no digits.
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

    /// The same fit to samples, at `time` of their run, each of whose noise is `correlation` of that of the one before it
    /// and else its own.
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

/// The part for value and slope of the covariance of a cubic's coefficients.
fn unscaled(covariance: &Matrix4<f64>, scale_s: f64) -> [[f64; 2]; 2] {
    let off = covariance[(0, 1)] / scale_s;
    let slope = covariance[(1, 1)] / (scale_s * scale_s);
    [[covariance[(0, 0)], off], [off, slope]]
}

fn powers(x: f64) -> Vector4<f64> {
    Vector4::new(1.0, x, x * x, x * x * x)
}

/// Samples within ± `half_width_s` of `time_s`, extended to the nearest [`FEWEST`].
fn around(time: &[f64], time_s: f64, half_width_s: f64) -> [usize; 2] {
    // A sample on the edge is inside, whatever rounding makes of it.
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
    fn nine_samples_at_the_ends_of_a_run() {
        let time = times(100);
        let position = vec![1.0; 100];
        let start = Restart::fit(&time, &position, 100.0, 0.001).unwrap();
        assert_eq!(start.samples, [0, 9]);
        let end = Restart::fit(&time, &position, 100.099, 0.001).unwrap();
        assert_eq!(end.samples, [91, 100]);
    }

    #[test]
    fn noise_that_a_low_pass_has_gone_over_averages_out_less() {
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
