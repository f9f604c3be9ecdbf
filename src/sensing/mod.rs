//! From counts to physical units, one file a sensor. Signs are made right here, once.

pub mod current;
pub mod encoder;
pub mod hall;

/// 12-bit converter with a 2.5 V reference: volts at the pin in one count.
const ADC_VOLTS_PER_COUNT: f32 = 2.5 / 4096.0;
