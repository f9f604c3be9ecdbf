//! Turns truths and diagnoses into the table of goals. These are pure functions without file access.

mod calibration;
mod judge;
mod messy;
mod summary;
mod transfer;

pub use calibration::{Bin, Calibration};
pub use judge::{FreshGaps, Gaps, Outcome, judge};
pub use summary::{Goal, Row, Summary};
pub use transfer::Kept;
