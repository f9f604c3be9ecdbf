//! Recordings cut into windows of prediction, with the state that was measured where each begins.

mod averaging;
pub(crate) mod excerpt;
mod inputs;
pub(crate) mod intersample;
pub(crate) mod motion;
pub(crate) mod noise;
pub mod restart;
pub mod series;
pub(crate) mod told;
pub(crate) mod unbroken;
