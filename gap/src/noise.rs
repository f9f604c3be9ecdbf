//! Noise of the position sensor, from the data themselves.

use crate::restart::Restart;
use crate::series::Window;
use recording::{Recording, Run};

/// Blocks in which the noise is judged, per window.
const BLOCKS: usize = 6;
/// Median of χ²/n is (1 − 2/(9 n))³ (Wilson and Hilferty, PNAS 17, 1931).
fn median_of_mean_square(freedom: f64) -> f64 {
    (1.0 - 2.0 / (9.0 * freedom)).powi(3)
}
/// A window's own noise counts up to this multiple of the run's: what is more is motion that no cubic
/// follows.
const LARGEST_RATIO: f64 = 2.0;
/// And down to this share: a sensor that stands on one count still moves within it.
const SMALLEST_RATIO: f64 = 0.3;

/// Gives every window its noise: what local cubics leave of the samples, held between shares of the
/// run's median so that neither an impact nor rest on one count decides.
///
/// Where the data are too few or too smooth to tell, the stated noise and quantum stand in.
pub(crate) fn assign(recording: &Recording, run: &Run, windows: &mut [Window]) {
    let sensor = recording.sensor("position");
    let stated = (sensor.noise.powi(2) + sensor.resolution.powi(2) / 12.0).sqrt();
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
            if let Some(fit) = fit.filter(|fit| fit.freedom() > 0) {
                let n = fit.freedom() as f64;
                sum += fit.residual;
                freedom += n;
                all.push(fit.residual / n / median_of_mean_square(n));
            }
        }
        own.push(if freedom > 0.0 { sum / freedom } else { 0.0 });
    }
    all.sort_by(f64::total_cmp);
    let median = all.get(all.len() / 2).map_or(0.0, |m| m.sqrt());
    // At rest on one count the median says nothing; the upper quartile still moves.
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
