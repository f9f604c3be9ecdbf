//! The blind check. It makes recordings of devices in which something is hidden, and scores a diagnosis of them.
//!
//! The simulator behind the recordings shares no code with the one that a diagnosis fits. It has other friction
//! formulations, other time stepping, its own sensors, and devices at random scales. A [`Case`] consists of a recording, a
//! fresh recording of the same device, and the [`Truth`]. The truth is opened only after the diagnosis is made.

mod case;
mod check;
mod diagnosis;
mod draw;
mod prediction;
mod reality;
mod scenario;
pub mod score;
mod session;
mod truth;

pub use case::{Case, CaseError, GAP_OVER_FLOOR, Mixture, SMALL_SHARE, Transfer, alike};
pub use check::{Check, CheckError};
pub use diagnosis::{Diagnosis, Found, Gap, Region, Verdict};
pub use draw::Draw;
pub use scenario::{OwnEffect, OwnEffectError, VOCABULARY};
pub use truth::{Effect, Kind, Place, Reference, Timing, Truth};
