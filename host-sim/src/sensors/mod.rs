//! What the board's converters read, noise and quantising included, one file a sensor.
//!
//! Each inverts what the control core's own sensing does with the reading, so that scales and signs stand in the core
//! alone.

mod current;
mod encoder;
mod hall;
mod noise;

pub use current::CurrentAmplifier;
pub use encoder::Encoder;
pub use hall::{Hall, HallReader};
pub use noise::Noise;
