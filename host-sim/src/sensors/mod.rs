//! Sensors with noise and quantisation, as the board's converters read them, one file per sensor.
//!
//! Each inverts the conversion of the control core. Scales and signs are therefore defined in the core only.

mod current;
mod encoder;
mod hall;
mod noise;

pub use current::CurrentAmplifier;
pub use encoder::Encoder;
pub use hall::{Hall, HallReader};
pub use noise::Noise;
