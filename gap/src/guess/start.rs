//! A point from which an effect is fitted: which of its numbers are free there, and of what size.

use crate::term::{Coordinate, Scale, Term};
use host_sim::effects::Kind;

/// A number that may be zero or change its sign, and what is much of it.
pub(crate) const fn linear(parameter: usize, start: f64, scale: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Linear(scale),
    }
}

/// The same from a guess: a share of it is much where it is large.
pub(crate) fn guessed(parameter: usize, start: f64, scale: f64) -> Coordinate {
    linear(parameter, start, scale.max(0.3 * start.abs()))
}

/// A number that is positive.
pub(crate) const fn log(parameter: usize, start: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Log,
    }
}

/// A term whose free coordinates are all its parameters but those given as fixed.
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

/// A guess, if there is one, and what is tried in any case.
pub(crate) fn terms(
    kind: &'static Kind,
    guess: Option<Vec<Coordinate>>,
    tried: impl IntoIterator<Item = Vec<Coordinate>>,
) -> Vec<Term> {
    let all = guess.into_iter().chain(tried);
    all.map(|free| term(kind, free, &[])).collect()
}

/// `count` values by equal ratios.
pub(crate) fn geometric([low, high]: [f64; 2], count: usize) -> impl Iterator<Item = f64> + Clone {
    let ratio = (high / low).powf(1.0 / (count - 1) as f64);
    (0..count).map(move |k| low * ratio.powi(k as i32))
}

/// How many values by equal ratios there are in a range, if `ratio` is the largest between two.
pub(crate) fn count([low, high]: [f64; 2], ratio: f64) -> usize {
    ((high / low).ln() / ratio.ln()).max(1.0).ceil() as usize + 1
}
