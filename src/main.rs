//! The firmware: the control core on the paddle's board.
//!
//! ```text
//! priority 4   bridge_fault   nFAULT: bridge off at once
//!              supply_fell    3.3 V: the same
//! priority 3   control        20 kHz: read the sensors, step the controller, write the duty
//! priority 2   sample         after each control period: telemetry, received bytes, Ctrl-C
//!              button         stops as Ctrl-C does
//! priority 1   send           the next chunk for the serial port's DMA
//! idle         console, watchdog, logging; reaches the controller only right after a control period
//! ```
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod firmware;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on the paddle's board. Build it with: cargo fw");
}
