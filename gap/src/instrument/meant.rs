//! Columns of another sign or unit, with which the model makes sense.

use crate::measure::Left;
use crate::windows::excerpt::excerpt;
use crate::windows::unbroken::Unbroken;
use core::f64::consts::PI;
use host_sim::device::Device;
use recording::{Model, Oddity, Recording};

/// Shares of what the model leaves as it is, and of what it leaves without any input, that it leaves at most once a column is read
/// as it was meant. Of 800 recordings that were right, whatever was hidden in them, none comes below; of the same ones with a
/// column turned round or in another unit nine in ten do.
const MOST_OF_TOLD: f64 = 0.5;
const MOST_OF_MUTE: f64 = 0.7;

/// Rows that suffice to tell signs and units: the model is gone through seven times.
const MOST_ROWS: usize = 200_000;

/// A column in another unit than the model takes it for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{column}` looks {} for [model], as {written} would be: read so, the model leaves {left:.3} of what it leaves as it is; give both in the same unit", size(*.factor))]
pub struct UnitMistake {
    /// The column.
    pub column: &'static str,
    /// By which it is too large, or too small if it is below one.
    pub factor: f64,
    /// In which unit it would be.
    pub written: &'static str,
    /// What the model leaves when the column is read so, as a share of what it leaves as it is.
    pub left: f64,
}

fn size(factor: f64) -> String {
    if factor < 1.0 {
        format!("{:.0} times too small", factor.recip())
    } else {
        format!("{factor:.0} times too large")
    }
}

/// Turns a model into the one for a column of the other sign.
pub(super) type Turn = fn(Model) -> Model;

/// How else the columns may be meant.
pub(super) enum Meant {
    /// A column has the other sign; with the function that turns the model accordingly.
    Turned(Turn, Oddity),
    /// In another unit.
    Scaled(UnitMistake),
}

/// What the model leaves if the columns are meant otherwise: the root mean square and the squares of each window, in units of
/// position as it is told.
struct Read {
    meant: Meant,
    rms: f64,
    squares: Vec<f64>,
}

/// How else they are, if the model then leaves far less, in most windows, and less than without any input.
pub(super) fn meant(recording: &Recording) -> Option<Meant> {
    let Unbroken {
        recording: unbroken,
        ..
    } = &Unbroken::of(recording);
    let unbroken = &*excerpt(unbroken, MOST_ROWS);
    let model = unbroken.model;
    let left = |model: &Model| Left::of(unbroken, &Device::nominal(model));
    let told = left(&model);
    let mute = left(&Model {
        ratio: 0.0,
        ..model
    });
    if told.rms <= MOST_OF_MUTE * mute.rms {
        return None;
    }
    let turned = [
        ("input", Model::turned as Turn),
        ("position", Model::mirrored),
    ];
    let turned = turned.map(|(column, turn)| {
        let Left { rms, squares, .. } = left(&turn(model));
        let oddity = Oddity::Turned {
            column,
            told: told.rms,
            mute: mute.rms,
            turned: rms,
            unit: recording.units.position.clone(),
        };
        let meant = Meant::Turned(turn, oddity);
        Read {
            meant,
            rms,
            squares,
        }
    });
    let scaled = units(recording.units.is_length()).map(|(column, factor, written)| {
        let (rms, squares) = scaled(unbroken, column, factor);
        let meant = Meant::Scaled(UnitMistake {
            column,
            factor,
            written,
            left: rms / told.rms,
        });
        Read {
            meant,
            rms,
            squares,
        }
    });
    let all = turned.into_iter().chain(scaled);
    let best = all.min_by(|a, b| a.rms.total_cmp(&b.rms))?;
    let pairs = best.squares.iter().zip(&told.squares);
    let less = pairs.filter(|(read, told)| read < told).count();
    let is_meant = best.rms <= MOST_OF_TOLD * told.rms
        && best.rms <= MOST_OF_MUTE * mute.rms
        && 2 * less > told.squares.len();
    is_meant.then_some(best.meant)
}

/// Columns, by how much they are too large in another unit, and that unit.
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

/// What the model leaves of a recording one of whose columns is so many times too large, in units of position as it is told.
fn scaled(recording: &Recording, column: &str, factor: f64) -> (f64, Vec<f64>) {
    let mut read = recording.clone();
    for run in &mut read.runs {
        let values = match column {
            "input" => &mut run.input,
            _ => &mut run.position,
        };
        values.iter_mut().for_each(|x| *x /= factor);
    }
    let left = Left::of(&read, &Device::nominal(&read.model));
    let told = if column == "input" { 1.0 } else { factor };
    let squares = left.squares.iter().map(|s| s * told.powi(2));
    (told * left.rms, squares.collect())
}
