//! The floor of the residuals and the expected loss of an exact model, from noise, quantization and restarts.

mod draws;
mod expected_loss;
mod ratio;
mod replicate;

pub(crate) use draws::{FLOOR_DOUBT, SAMPLED_WINDOWS, floor_squares};
pub(crate) use expected_loss::{ExpectedLoss, WHITE, mean_and_error};
