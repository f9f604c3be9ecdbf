//! From truths and diagnoses to the table of goals: pure functions, no files.

mod calibration;
mod judge;
mod messy;
mod summary;
mod transfer;

pub use calibration::{Bin, Calibration};
pub use judge::{FreshGaps, Gaps, Outcome, judge};
pub use summary::{Goal, Row, Summary};
pub use transfer::Kept;
