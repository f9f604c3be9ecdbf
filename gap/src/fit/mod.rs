//! Rival models fitted to the windows of a recording.

pub(crate) mod costs;
pub(crate) mod ground;
pub(crate) mod hypothesis;
mod least_squares;
pub(crate) mod part;
mod polish;
pub(crate) mod problem;
pub(crate) mod stalls;
mod strain;
pub(crate) mod whitening;

pub(crate) use least_squares::{DIFFERENCES, Fit, Slope, aside, within};
