//! The difference between two columns of one position, and the residual of a sensing effect that explains it.

use super::pair::{Columns, Track};
use host_sim::device::Device;
use host_sim::effects::Kind;
use host_sim::sensing::Reading;
use nalgebra::{DMatrix, DVector};
use recording::Model;

/// Number of grid points of a search along one parameter, and of the narrowing steps after it.
const GRID: usize = 24;
const NARROWINGS: usize = 24;

/// The difference between two columns, with the magnitudes of the motion.
pub(crate) struct Disagreement<'a> {
    pub columns: &'a Columns,
    /// Shown less reference position of each sample.
    pub difference: Vec<f64>,
    /// Reference position of each sample.
    pub reference: Vec<f64>,
    /// Range of the reference positions.
    pub span: f64,
    /// Largest magnitude of the reference positions.
    pub reach: f64,
    /// Duration of a window, s.
    pub window_s: f64,
}

impl<'a> Disagreement<'a> {
    pub(crate) fn of(columns: &'a Columns) -> Self {
        let tracks = &columns.tracks;
        let reference: Vec<f64> = tracks.iter().flat_map(|t| &t.reference).copied().collect();
        let (low, high) = reference
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(*x), high.max(*x))
            });
        let window = tracks.first().and_then(|track| {
            let window = track.windows.first()?;
            Some(track.session_s[window.end - 1] - track.session_s[window.start])
        });
        Self {
            columns,
            difference: differences(tracks),
            span: (high - low).max(f64::MIN_POSITIVE),
            reach: low.abs().max(high.abs()).max(f64::MIN_POSITIVE),
            window_s: window.unwrap_or(0.0).max(f64::MIN_POSITIVE),
            reference,
        }
    }

    /// Mean square of the difference less its mean.
    pub(crate) fn before(&self) -> f64 {
        mean_square(&less_mean(self.difference.clone()))
    }

    /// Mean squared residual of an effect.
    pub(crate) fn left(&self, kind: &Kind, values: &[f64]) -> f64 {
        mean_square(&residuals(&self.columns.tracks, kind, values))
    }

    /// Coefficients of functions of the reference that fit the difference best. Returns `None` if the data do not determine them.
    pub(crate) fn linear<const N: usize>(&self, row: impl Fn(f64) -> [f64; N]) -> Option<[f64; N]> {
        let mut normal = DMatrix::<f64>::zeros(N, N);
        let mut right = DVector::<f64>::zeros(N);
        for (&x, difference) in self.reference.iter().zip(&self.difference) {
            let row = row(x);
            for a in 0..N {
                right[a] += row[a] * difference;
                for b in 0..N {
                    normal[(a, b)] += row[a] * row[b];
                }
            }
        }
        let solution = normal.cholesky()?.solve(&right);
        let found: [f64; N] = core::array::from_fn(|i| solution[i]);
        found.iter().all(|c| c.is_finite()).then_some(found)
    }
}

/// Readings of a sensor with an effect along the reference of a track, one per sample.
pub(crate) fn read(track: &Track, kind: &Kind, values: &[f64]) -> Vec<f64> {
    let mut device = Device::nominal(&Model::new(1.0));
    kind.install(&mut device, values);
    let sensing = &device.sensing;
    let mut reading = Reading::at_rest(sensing, track.reference[0]);
    let mut before_s = track.session_s[0];
    let moments = track.session_s.iter().zip(&track.reference);
    moments
        .map(|(&now_s, &x)| {
            let y = reading.follow(sensing, x, now_s - before_s) + sensing.jumped(now_s);
            before_s = now_s;
            y
        })
        .collect()
}

/// Residuals of the shown column if the effect acts on the reference, one per sample over all tracks, less their mean. The zeros of the
/// columns may differ.
pub(crate) fn residuals(tracks: &[Track], kind: &Kind, values: &[f64]) -> Vec<f64> {
    let residuals = tracks.iter().flat_map(|track| {
        let pairs = track.shown.iter().zip(read(track, kind, values));
        pairs.map(|(shown, y)| shown - y)
    });
    less_mean(residuals.collect())
}

/// The difference between the columns, less its mean.
pub(crate) fn disagreement(tracks: &[Track]) -> Vec<f64> {
    less_mean(differences(tracks))
}

fn differences(tracks: &[Track]) -> Vec<f64> {
    let differences = tracks.iter().flat_map(|track| {
        let pairs = track.shown.iter().zip(&track.reference);
        pairs.map(|(shown, x)| shown - x)
    });
    differences.collect()
}

/// The values less their mean.
pub(crate) fn less_mean(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|v| *v -= mean);
    values
}

/// Mean of the squares.
pub(crate) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64
}

/// The argument of the minimum of `f` in a range of positive values: on a logarithmic grid, then by golden-section search around its
/// lowest point (Kiefer, Proceedings of the AMS 4, 1953).
pub(crate) fn lowest(range: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let [low, high] = range.map(f64::ln);
    let at = |k: usize| low + (high - low) * k as f64 / (GRID - 1) as f64;
    let values: Vec<f64> = (0..GRID).map(|k| f(at(k).exp())).collect();
    let best = (0..GRID).min_by(|&a, &b| values[a].total_cmp(&values[b]));
    let best = best.unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(GRID - 1)));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut fc, mut fd) = (f(c.exp()), f(d.exp()));
    for _ in 0..NARROWINGS {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - golden * (b - a);
            fc = f(c.exp());
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + golden * (b - a);
            fd = f(d.exp());
        }
    }
    (0.5 * (a + b)).exp()
}
