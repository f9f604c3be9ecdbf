//! Sensors: from counts to physical units, one file per sensor. Signs are corrected here and nowhere else.

pub mod current;
pub mod encoder;
pub mod hall;

/// Volts at the pin per count, for a 12-bit converter with a 2.5 V reference.
const ADC_VOLTS_PER_COUNT: f32 = 2.5 / 4096.0;
