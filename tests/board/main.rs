//! Tests of the firmware image on the virtual board.
//!
//! `cargo xtask test` builds the image first. Without an image these tests are skipped with a message.

mod bench;
mod boot;
mod bridge_line;
mod console;
mod control_interrupt;
mod current;
mod debugger;
mod emergencies;
mod lends;
mod load;
mod power;
mod procedures;
mod replay;
mod safety;
mod serial_line;
mod step_response;
mod stored_settings;
mod telemetry;
