//! Detects columns with another sign or unit, with which the model fits far better.

use crate::columns::lowest;
use crate::measure::Residual;
use crate::windows::excerpt::excerpt;
use crate::windows::series::median_period;
use crate::windows::unbroken::Unbroken;
use core::f64::consts::PI;
use host_sim::device::Device;
use recording::{Model, Oddity, Recording};

/// Largest residual with a corrected column, as a share of the residual as recorded, and as a share of the residual without any input.
const MOST_OF_RECORDED: f64 = 0.5;
const MOST_WITHOUT_INPUT: f64 = 0.7;

/// Number of rows that suffices to detect signs and units. The model is simulated seven times, and some fifty times more if a
/// hypothesis is confirmed.
const MOST_ROWS: usize = 200_000;

/// A column in another unit than the model assumes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{column}` looks {} for [model], like {written}: converted, it reduces the residual of the model to {left:.3} of the present one; give both in the same unit", size(*.factor))]
pub struct UnitMistake {
    /// The column.
    pub column: &'static str,
    /// Factor by which the values are too large, or too small if it is below 1.
    pub factor: f64,
    /// The unit mistake in words.
    pub written: &'static str,
    /// Residual of the model with the corrected column, as a share of the residual as recorded.
    pub left: f64,
}

fn size(factor: f64) -> String {
    if factor < 1.0 {
        format!("{:.0} times too small", factor.recip())
    } else {
        format!("{factor:.0} times too large")
    }
}

/// Converts a model to the opposite sign of a column.
pub(super) type Turn = fn(Model) -> Model;

/// A hypothesis about the sign or unit of a column.
pub(super) enum SignOrUnit {
    /// A column has the opposite sign. The function converts the model accordingly.
    OppositeSign(Turn, Oddity),
    /// A column has another unit.
    Scaled(UnitMistake),
}

/// The residual of the model under a hypothesis: the rms in recorded position units, and the sum of squares of each window in recorded
/// position units squared.
struct HypothesisResidual {
    hypothesis: SignOrUnit,
    rms: f64,
    squares: Vec<f64>,
}

/// The best hypothesis about a sign or unit, if with it the residual is far smaller, smaller in most windows, and smaller than without
/// any input.
pub(super) fn sign_or_unit(recording: &Recording) -> Option<SignOrUnit> {
    let Unbroken {
        recording: unbroken,
        ..
    } = &Unbroken::of(recording);
    let unbroken = &*excerpt(unbroken, MOST_ROWS);
    let model = unbroken.model;
    let residual = |model: &Model| Residual::of(unbroken, &Device::nominal(model));
    let recorded = residual(&model);
    let without_input = residual(&Model {
        ratio: 0.0,
        ..model
    });
    if recorded.rms <= MOST_WITHOUT_INPUT * without_input.rms {
        return None;
    }
    let turned = [
        ("input", Model::turned as Turn),
        ("position", Model::mirrored),
    ];
    let turned = turned.map(|(column, turn)| {
        let Residual { rms, squares, .. } = residual(&turn(model));
        let oddity = Oddity::OppositeSign {
            column,
            as_logged: recorded.rms,
            without_input: without_input.rms,
            corrected: rms,
            unit: recording.units.position.clone(),
        };
        let hypothesis = SignOrUnit::OppositeSign(turn, oddity);
        HypothesisResidual {
            hypothesis,
            rms,
            squares,
        }
    });
    let scaled = units(recording.units.is_length()).map(|(column, factor, written)| {
        let (rms, squares) = scaled(unbroken, column, factor);
        let hypothesis = SignOrUnit::Scaled(UnitMistake {
            column,
            factor,
            written,
            left: rms / recorded.rms,
        });
        HypothesisResidual {
            hypothesis,
            rms,
            squares,
        }
    });
    let all = turned.into_iter().chain(scaled);
    let best = all.min_by(|a, b| a.rms.total_cmp(&b.rms))?;
    let pairs = best.squares.iter().zip(&recorded.squares);
    let less = pairs.filter(|(read, recorded)| read < recorded).count();
    let is_confirmed = best.rms <= MOST_OF_RECORDED * recorded.rms
        && best.rms <= MOST_WITHOUT_INPUT * without_input.rms
        && 2 * less > recorded.squares.len();
    if !is_confirmed {
        return None;
    }
    let delayed = best_delayed_rms(unbroken).unwrap_or(f64::INFINITY);
    (best.rms < delayed).then_some(best.hypothesis)
}

/// Lowest rms residual of the model with an additional delay of the input, in recorded position units. An input that is late by half a
/// period of the motion looks like one of the opposite sign. A delay is tried up to the horizon. It has at least one row, because half
/// a period of a motion that the rows show is no shorter. Returns `None` if a row is longer than the horizon.
fn best_delayed_rms(recording: &Recording) -> Option<f64> {
    let model = recording.model;
    let rms = |delay_s: f64| {
        let delay = model.delay + delay_s;
        Residual::of(recording, &Device::nominal(&Model { delay, ..model })).rms
    };
    let rows_s = recording.runs.iter().map(|run| median_period(&run.time));
    let row_s = rows_s.reduce(f64::min)?;
    (row_s < recording.horizon).then(|| rms(lowest([row_s, recording.horizon], rms)))
}

/// Unit hypotheses: the column, the factor by which its values would be too large, and the unit mistake in words.
fn units(is_length: bool) -> [(&'static str, f64, &'static str); 3] {
    let (factor, written) = if is_length {
        (1e3, "millimetres for metres")
    } else {
        (180.0 / PI, "degrees for radians")
    };
    [
        ("position", factor, written),
        ("input", 1e3, "thousandths for whole units"),
        ("input", 1e-3, "whole units for thousandths"),
    ]
}

/// Residual of the model if the values of one column are divided by `factor`: the rms, and the sum of squares of each window, in recorded
/// position units.
fn scaled(recording: &Recording, column: &str, factor: f64) -> (f64, Vec<f64>) {
    let mut corrected = recording.clone();
    for run in &mut corrected.runs {
        let values = match column {
            "input" => &mut run.input,
            _ => &mut run.position,
        };
        values.iter_mut().for_each(|x| *x /= factor);
    }
    let residual = Residual::of(&corrected, &Device::nominal(&corrected.model));
    let unit = if column == "input" { 1.0 } else { factor };
    let squares = residual.squares.iter().map(|s| s * unit.powi(2));
    (unit * residual.rms, squares.collect())
}
