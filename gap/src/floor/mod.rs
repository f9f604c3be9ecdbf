//! What noise, quantising and restarts alone leave of a model that is right.

mod draws;
mod imagined;
mod perfect;
mod ratio;

pub(crate) use draws::{FLOOR_DOUBT, LOOKED_AT, floor_squares};
pub(crate) use perfect::{Perfect, WHITE, mean_and_error};
