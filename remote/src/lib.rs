//! Communication with a paddle's board over a serial port.
//!
//! ```text
//! Wire       bytes: a serial port, a pseudo-terminal, or a virtual board in this process
//! Device     commands with their answers, rows of the stream, captures
//! Plan       an experiment as it is written: step:10, torque:multisine:0.0036,2,4
//! take       carries a plan out, and gives its rows
//! Recorder   puts runs together to a recording
//! ```
//!
//! Only the wires distinguish a real board from a virtual one.

mod capture;
mod device;
mod error;
mod plan;
mod recorder;
mod take;
mod virtual_wire;
mod wire;

pub use capture::Captured;
pub use device::{Device, Row};
pub use error::DeviceError;
pub use plan::{Plan, PlanError};
pub use recorder::{Recorder, Session};
pub use take::{Progress, Taken, take};
pub use virtual_wire::VirtualWire;
pub use wire::{BOOT_BAUD, FAST_BAUD, SerialWire, Wire};
