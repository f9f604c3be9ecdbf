//! The blind check: recordings of devices with something hidden in them, and the score of a diagnosis on them.
//!
//! The reality behind the recordings shares nothing with the simulator that a diagnosis fits: other friction
//! formulations, other time stepping, its own sensors and devices at random scales. A [`Case`] is one recording, a fresh
//! one of the same device, and the [`Truth`], which is opened only after the diagnosis is made.

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
pub use scenario::VOCABULARY;
pub use truth::{Effect, Kind, Place, Reference, Timing, Truth};
