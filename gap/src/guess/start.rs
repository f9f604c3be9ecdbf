//! The point from which an effect is fitted: which of its parameters are free, their start values and their scales.

use crate::term::{Coordinate, Scale, Term};
use host_sim::effects::Kind;

/// A free parameter that may be zero or negative. One unit of its coordinate is `scale`.
pub(crate) const fn linear(parameter: usize, start: f64, scale: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Linear(scale),
    }
}

/// A free parameter with an estimated start. One unit of its coordinate is `scale`, or 30 % of the start if that is larger.
pub(crate) fn guessed(parameter: usize, start: f64, scale: f64) -> Coordinate {
    linear(parameter, start, scale.max(0.3 * start.abs()))
}

/// A free positive parameter, with a logarithmic coordinate.
pub(crate) const fn log(parameter: usize, start: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Log,
    }
}

/// A term with free coordinates and fixed values. The other parameters have their default values.
pub(crate) fn term(kind: &'static Kind, free: Vec<Coordinate>, fixed: &[(usize, f64)]) -> Term {
    let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
    for coordinate in &free {
        values[coordinate.parameter] = coordinate.start;
    }
    for &(parameter, value) in fixed {
        values[parameter] = value;
    }
    Term {
        kind,
        values,
        free,
        sensor_on_load: false,
    }
}

/// Terms from an estimate, if any, and from the fixed list of starts.
pub(crate) fn terms(
    kind: &'static Kind,
    guess: Option<Vec<Coordinate>>,
    tried: impl IntoIterator<Item = Vec<Coordinate>>,
) -> Vec<Term> {
    let all = guess.into_iter().chain(tried);
    all.map(|free| term(kind, free, &[])).collect()
}

/// `count` values from `low` to `high` in geometric progression.
pub(crate) fn geometric([low, high]: [f64; 2], count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (high / low).powf(1.0 / (count - 1) as f64);
    (0..count).map(move |k| low * ratio.powi(k as i32))
}

/// Number of values in a geometric progression over a range, with at most `ratio` between neighbours.
pub(crate) fn count([low, high]: [f64; 2], ratio: f64) -> usize {
    ((high / low).ln() / ratio.ln()).max(1.0).ceil() as usize + 1
}
