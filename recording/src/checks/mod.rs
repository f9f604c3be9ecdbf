//! Checks of the numbers in a recording: impossible values, invalid rows, and oddities.

mod constant_segments;
mod frozen;
pub(crate) mod invalid_rows;
pub(crate) mod odd;
pub(crate) mod plausible;
pub(crate) mod repeated_rows;
mod saturated;
mod spikes;
