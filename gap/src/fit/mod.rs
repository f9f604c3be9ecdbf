//! Fits hypotheses to the windows of a recording.

pub(crate) mod costs;
mod fitted;
pub(crate) mod hypothesis;
mod least_squares;
pub(crate) mod linearization;
pub(crate) mod objective;
pub(crate) mod part;
mod polish;
pub(crate) mod problem;
mod slopes;
pub(crate) mod stalls;
pub(crate) mod whitening;

pub(crate) use fitted::Fit;
pub(crate) use slopes::{DIFFERENCES, difference_within};
