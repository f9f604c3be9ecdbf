//! Supervision: it turns the bridge off, names the fault, and keeps a record of faults.
//!
//! ```text
//! limits    at every position tick: travel, speed, current, encoder against Hall sensor
//! monitor   at every millisecond: voltage against current, heat, stall, an encoder that stands still
//! record    faults with what was there at their moment; and counts of limits that merely act
//! ```

mod fault;
mod limits;
mod monitor;
mod record;
mod reset;

pub use fault::Fault;
pub use limits::Limits;
pub use monitor::{Monitor, MonitorGains};
pub use record::{Acted, Counters, FaultLog, FaultRecord, WORDS_PER_RECORD};
pub use reset::ResetCause;
