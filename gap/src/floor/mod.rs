//! What noise, quantising and restarts alone leave of a model that is right.

mod draws;
mod expected_loss;
mod ratio;
mod replicate;

pub(crate) use draws::{FLOOR_DOUBT, LOOKED_AT, floor_squares};
pub(crate) use expected_loss::{ExpectedLoss, WHITE, mean_and_error};
