//! What is looked for in the numbers of a recording: what no device could show, which rows are invalid, and what is merely odd.

mod constant_segments;
mod frozen;
pub(crate) mod invalid_rows;
pub(crate) mod odd;
pub(crate) mod plausible;
pub(crate) mod repeated_rows;
mod saturated;
mod spikes;
