//! Ripple of several orders, by regression on the whole map at once.

use super::path::Path;
use super::regression::{Normal, Rows};
use super::ripple::Waves;
use super::shortlist::respond;
use super::smoother::Smoother;

/// Orders that are looked for at most.
const MOST: usize = 8;
/// Share of the missing torque, squared, that an order must explain on held-out time, and of what the others leave.
const LEAST_SHARE: f64 = 0.004;
const LEAST_OF_REST: f64 = 0.05;
/// Rounds in which the wave numbers are refined, all orders together, and parts of a peak's width that they move by.
const ROUNDS: usize = 2;
const MOVES: [f64; 6] = [-0.4, -0.15, -0.05, 0.05, 0.15, 0.4];

/// One wave of a ripple: `amplitude · sin(wave_number · x + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Rad per unit of position.
    pub wave_number: f64,
    /// Torque, in units of input times the ratio.
    pub amplitude: f64,
    /// At position zero, rad.
    pub phase: f64,
}

/// The orders of a ripple beside friction and a constant, the largest first.
pub(super) fn orders(
    path: &Path<'_>,
    smoother: &Smoother<'_>,
    rows: &Rows,
    torque: &[f64],
    corner: f64,
) -> Vec<Order> {
    let smoothed = |columns: &[Vec<f64>]| respond(smoother, rows, columns, &[]);
    let n = path.position.len();
    let beside = smoothed(&[
        vec![1.0; n],
        path.direction.clone(),
        path.velocity.clone(),
        path.position.clone(),
    ]);
    // While they are looked for, the smoother is taken as a low-pass of the rate at which a wave is passed.
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
    let exact = |wave_number: f64| {
        let wave = |f: fn(f64) -> f64| path.position.iter().map(|x| f(wave_number * x)).collect();
        smoothed(&[wave(f64::sin), wave(f64::cos)])
    };
    let mut found: Vec<(f64, Vec<Vec<f64>>)> = Vec::new();
    let mut left = Fit::of(rows, &beside, &found, torque);
    let peak = core::f64::consts::PI / path.scale.half_span();
    while found.len() < MOST {
        let waves = Waves::of(path, rows, &left.rest, corner);
        let Some(&next) = waves.strongest.first() else {
            break;
        };
        let mut more = found.clone();
        more.push((next, wave(next)));
        let fit = Fit::of(rows, &beside, &more, torque);
        let gain = left.held_out - fit.held_out;
        if gain < LEAST_SHARE * fit.squares || gain < LEAST_OF_REST * left.held_out {
            break;
        }
        (found, left) = (more, fit);
    }
    for _ in 0..ROUNDS {
        for k in 0..found.len() {
            let before = found[k].0;
            for part in MOVES {
                let moved = before + part * peak;
                let mut tried = found.clone();
                tried[k] = (moved, wave(moved));
                let fit = Fit::of(rows, &beside, &tried, torque);
                if fit.held_out < left.held_out {
                    (found, left) = (tried, fit);
                }
            }
        }
    }
    found
        .iter_mut()
        .for_each(|(wave_number, wave)| *wave = exact(*wave_number));
    let left = Fit::of(rows, &beside, &found, torque);
    let waves = left.coefficients[beside.len()..].chunks(2);
    let orders = found.iter().zip(waves).map(|((wave_number, _), c)| Order {
        wave_number: *wave_number,
        amplitude: c[0].hypot(c[1]),
        phase: c[1].atan2(c[0]),
    });
    let mut orders: Vec<Order> = orders.collect();
    orders.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    orders
}

/// All orders fitted at once.
struct Fit {
    coefficients: Vec<f64>,
    rest: Vec<f64>,
    held_out: f64,
    squares: f64,
}

impl Fit {
    fn of(
        rows: &Rows,
        beside: &[Vec<f64>],
        waves: &[(f64, Vec<Vec<f64>>)],
        torque: &[f64],
    ) -> Self {
        let columns = beside.iter().chain(waves.iter().flat_map(|(_, wave)| wave));
        let columns: Vec<&[f64]> = columns.map(Vec::as_slice).collect();
        let normal = Normal::of(rows, &columns, 0, torque);
        let all: Vec<usize> = (0..columns.len()).collect();
        let coefficients = normal.fit(&all);
        let mut rest = torque.to_vec();
        for (column, c) in columns.iter().zip(&coefficients) {
            rest.iter_mut()
                .zip(*column)
                .for_each(|(rest, value)| *rest -= c * value);
        }
        Self {
            held_out: normal.held_out(&all),
            squares: normal.target_squares(),
            coefficients,
            rest,
        }
    }
}
