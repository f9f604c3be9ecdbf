//! From truths and diagnoses to the table of goals: pure functions, no files.

mod calibration;
mod judge;
mod summary;

pub use calibration::{Bin, Calibration};
pub use judge::{FreshGaps, Outcome, judge};
pub use summary::{Goal, Row, Summary};
