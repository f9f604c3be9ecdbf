//! Draws random devices, their excitation, and what is hidden in them.

mod excitation;
mod foreign;
mod hidden;
mod own;
mod plan;
mod plant;

pub(crate) use excitation::Waveform;
pub(crate) use foreign::Cause;
pub use hidden::VOCABULARY;
pub(crate) use hidden::{Hidden, OVERSTATED_LIMITS, Scale};
pub(crate) use own::HiddenOwn;
pub use own::{OwnEffect, OwnEffectError};
pub(crate) use plan::{Drive, Plan};
pub(crate) use plant::{Family, Plant};
