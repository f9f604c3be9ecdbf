//! Finds the orders of a ripple, by regression over all rows at once.

use super::path::Path;
use super::regression::{Normal, Rows};
use super::ripple::Waves;
use super::shortlist::respond;
use super::smoother::Smoother;

/// Largest number of orders.
const MOST_ORDERS: usize = 8;
/// Share of the squared missing torque that an order must explain on held-out data, and its least share of the squares that the other
/// orders leave.
const LEAST_SHARE: f64 = 0.004;
const LEAST_OF_RESIDUAL: f64 = 0.05;
/// Number of refinements of the wave numbers, with all orders fitted together, and the steps of a wave number, in widths of a peak.
const ROUNDS: usize = 2;
const STEPS: [f64; 6] = [-0.4, -0.15, -0.05, 0.05, 0.15, 0.4];

/// One wave of a ripple: `amplitude · sin(wave_number · x + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Wave number, rad per position unit.
    pub wave_number: f64,
    /// Torque amplitude, in input units times the ratio of the drive.
    pub amplitude: f64,
    /// Phase at position zero, rad.
    pub phase: f64,
}

/// The orders of a ripple, largest first. They are fitted together with Coulomb friction, viscous friction, a linear spring and a
/// constant.
pub(super) fn orders(
    path: &Path<'_>,
    smoother: &Smoother<'_>,
    rows: &Rows,
    torque: &[f64],
    corner: f64,
) -> Vec<Order> {
    let smoothed = |columns: &[Vec<f64>]| respond(smoother, rows, columns, &[]);
    let n = path.position.len();
    let baseline = smoothed(&[
        vec![1.0; n],
        path.direction.clone(),
        path.velocity.clone(),
        path.position.clone(),
    ]);
    // During the search the smoother is approximated by a low-pass at the temporal frequency of the wave.
    let wave = |wave_number: f64| -> Vec<Vec<f64>> {
        let at = |f: fn(f64) -> f64| {
            let passed = rows.rows.iter().map(|&row| {
                let z = (wave_number * path.velocity[row] / corner).powi(2);
                f(wave_number * path.position[row]) / (1.0 + z * z * z)
            });
            passed.collect()
        };
        vec![at(f64::sin), at(f64::cos)]
    };
    let smoothed_wave = |wave_number: f64| {
        let wave = |f: fn(f64) -> f64| path.position.iter().map(|x| f(wave_number * x)).collect();
        smoothed(&[wave(f64::sin), wave(f64::cos)])
    };
    let mut found: Vec<(f64, Vec<Vec<f64>>)> = Vec::new();
    let mut current = Fit::of(rows, &baseline, &found, torque);
    let peak = core::f64::consts::PI / path.scale.half_span();
    while found.len() < MOST_ORDERS {
        let waves = Waves::of(path, rows, &current.residual, corner);
        let Some(&next) = waves.strongest.first() else {
            break;
        };
        let mut more = found.clone();
        more.push((next, wave(next)));
        let fit = Fit::of(rows, &baseline, &more, torque);
        let gain = current.held_out - fit.held_out;
        if gain < LEAST_SHARE * fit.squares || gain < LEAST_OF_RESIDUAL * current.held_out {
            break;
        }
        (found, current) = (more, fit);
    }
    for _ in 0..ROUNDS {
        for k in 0..found.len() {
            let before = found[k].0;
            for part in STEPS {
                let moved = before + part * peak;
                let mut tried = found.clone();
                tried[k] = (moved, wave(moved));
                let fit = Fit::of(rows, &baseline, &tried, torque);
                if fit.held_out < current.held_out {
                    (found, current) = (tried, fit);
                }
            }
        }
    }
    found
        .iter_mut()
        .for_each(|(wave_number, wave)| *wave = smoothed_wave(*wave_number));
    let current = Fit::of(rows, &baseline, &found, torque);
    let waves = current.coefficients[baseline.len()..].chunks(2);
    let orders = found.iter().zip(waves).map(|((wave_number, _), c)| Order {
        wave_number: *wave_number,
        amplitude: c[0].hypot(c[1]),
        phase: c[1].atan2(c[0]),
    });
    let mut orders: Vec<Order> = orders.collect();
    orders.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    orders
}

/// A fit of all orders at once.
struct Fit {
    coefficients: Vec<f64>,
    residual: Vec<f64>,
    held_out: f64,
    squares: f64,
}

impl Fit {
    fn of(
        rows: &Rows,
        baseline: &[Vec<f64>],
        waves: &[(f64, Vec<Vec<f64>>)],
        torque: &[f64],
    ) -> Self {
        let columns = baseline
            .iter()
            .chain(waves.iter().flat_map(|(_, wave)| wave));
        let columns: Vec<&[f64]> = columns.map(Vec::as_slice).collect();
        let normal = Normal::of(rows, &columns, 0, torque);
        let all: Vec<usize> = (0..columns.len()).collect();
        let coefficients = normal.fit(&all);
        let mut residual = torque.to_vec();
        for (column, c) in columns.iter().zip(&coefficients) {
            residual
                .iter_mut()
                .zip(*column)
                .for_each(|(residual, value)| *residual -= c * value);
        }
        Self {
            held_out: normal.held_out(&all),
            squares: normal.target_squares(),
            coefficients,
            residual,
        }
    }
}
