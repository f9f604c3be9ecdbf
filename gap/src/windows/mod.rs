//! Divides recordings into prediction windows, each with the measured state at its begin.

mod averaging;
pub(crate) mod drive_response;
pub(crate) mod excerpt;
mod inputs;
pub(crate) mod intersample;
pub(crate) mod motion;
pub(crate) mod noise;
pub mod restart;
pub(crate) mod run_order;
pub mod series;
pub(crate) mod statistics;
mod torque_profiles;
pub(crate) mod unbroken;
mod window;
