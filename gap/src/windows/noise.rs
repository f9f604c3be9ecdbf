//! Estimates the noise of the position sensor from the data.

use super::restart::Restart;
use super::statistics::quantile;
use super::window::Window;
use nalgebra::DMatrix;
use recording::{Recording, Run, low_pass_gain};

/// Number of places per window at which the noise is estimated.
const BLOCKS: usize = 6;

/// Median of χ²/n for n degrees of freedom: (1 − 2/(9 n))³ (Wilson and Hilferty, PNAS 17, 1931).
fn median_of_mean_square(freedom: f64) -> f64 {
    (1.0 - 2.0 / (9.0 * freedom)).powi(3)
}

/// Largest noise of a window over that of the run. A larger residual is motion that a cubic cannot follow.
const LARGEST_RATIO: f64 = 2.0;
/// Least noise of a window over that of the run. A sensor that shows a constant count still moves within the count.
const SMALLEST_RATIO: f64 = 0.3;

/// Least degrees of freedom for an estimate of the noise.
const LEAST_FREEDOM: f64 = 0.5;
/// Largest number of places at which the correlation of the noise is estimated.
const MOST_PLACES: usize = 300;

/// Correlation of the noise of consecutive samples. It is that of the low-pass of the column if the samples show it, and otherwise 0,
/// because then the noise was added behind the low-pass.
pub(crate) fn correlation(recording: &Recording, run: &Run, period_s: f64) -> f64 {
    let cutoff_hz = recording.sensor("position").cutoff_hz;
    let by_low_pass = 1.0 - low_pass_gain(cutoff_hz, period_s);
    if by_low_pass <= 0.0 {
        return 0.0;
    }
    let rows = run.time.len();
    let every = rows.div_ceil(MOST_PLACES).max(1);
    let half_width_s = recording.restart_half_width;
    let fits = run.time.iter().step_by(every);
    let fits = fits.filter_map(|&t| Restart::fit(&run.time, &run.position, t, half_width_s));
    let fits: Vec<Restart> = fits.filter(|fit| fit.residual > 0.0).collect();
    let correlations: Vec<f64> = fits.iter().map(|f| f.neighbours / f.residual).collect();
    let samples = fits.iter().map(|f| f.samples[1] - f.samples[0]).max();
    let misfit = |correlation: f64| {
        let left = residual_correlation(samples.unwrap_or(0), correlation);
        (quantile(&correlations, 0.5) - left).abs()
    };
    if misfit(by_low_pass) < misfit(0.0) {
        by_low_pass
    } else {
        0.0
    }
}

/// Standard deviation of the mean of some samples, relative to that of one sample.
pub(crate) fn noise_of_mean(samples: usize, correlation: f64) -> f64 {
    let n = samples as f64;
    let shared = (1..samples).map(|k| (1.0 - k as f64 / n) * correlation.powi(k as i32));
    ((1.0 + 2.0 * shared.sum::<f64>()) / n).sqrt()
}

/// Correlation of consecutive residuals of a cubic that is fitted by least squares to evenly spaced samples with correlated noise.
fn residual_correlation(samples: usize, correlation: f64) -> f64 {
    let at = |i: usize| (2 * i) as f64 / samples as f64 - 1.0;
    let powers = DMatrix::from_fn(samples, 4, |i, k| at(i).powi(k as i32));
    let Some(inverse) = powers.tr_mul(&powers).try_inverse() else {
        return 0.0;
    };
    let left = DMatrix::identity(samples, samples) - &powers * inverse * powers.transpose();
    let noise = DMatrix::from_fn(samples, samples, |i, j| {
        correlation.powi(i.abs_diff(j) as i32)
    });
    let covariance = &left * noise * &left;
    let neighbours: f64 = (1..samples).map(|i| covariance[(i - 1, i)]).sum();
    neighbours / covariance.trace()
}

/// Sets the noise of every window from the residuals of local cubics. The noise is limited to a range around the median of the run, so
/// that neither an impact nor a constant count determines it.
///
/// If the data are too few or too smooth, the stated noise and resolution are used.
pub(crate) fn assign(recording: &Recording, run: &Run, correlation: f64, windows: &mut [Window]) {
    let stated = recording.sensor("position").deviation();
    let mut own = Vec::with_capacity(windows.len());
    let mut all = Vec::new();
    for window in windows.iter() {
        let mut sum = 0.0;
        let mut freedom = 0.0;
        let (first, last) = (window.samples.start, window.samples.end - 1);
        for block in 0..BLOCKS {
            let at = first + (last - first) * (2 * block + 1) / (2 * BLOCKS);
            let fit = Restart::fit(
                &run.time,
                &run.position,
                run.time[at],
                recording.restart_half_width,
            );
            let fit = fit.map(|fit| fit.correlated(&run.time, correlation));
            if let Some(fit) = fit.filter(|fit| fit.freedom >= LEAST_FREEDOM) {
                let n = fit.freedom;
                sum += fit.residual;
                freedom += n;
                all.push(fit.residual / n / median_of_mean_square(n));
            }
        }
        own.push(if freedom > 0.0 { sum / freedom } else { 0.0 });
    }
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).map_or(0.0, |m| m.sqrt());
    // At standstill on one count the median is zero, while the upper quartile is not.
    let upper = all.get(all.len() * 3 / 4).map_or(0.0, |m| m.sqrt());
    let typical = if median > 0.0 { median } else { upper };
    let typical = if typical > 0.0 {
        typical.max(SMALLEST_RATIO * stated)
    } else {
        stated
    };
    for (window, own) in windows.iter_mut().zip(own) {
        window.noise = own
            .sqrt()
            .clamp(SMALLEST_RATIO * typical, LARGEST_RATIO * typical)
            .max(f64::MIN_POSITIVE);
        window.restart_noise = window.noise;
    }
}
