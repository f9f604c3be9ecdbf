//! Events that other interrupts report to the control loop, as bits of one word.

use core::sync::atomic::{AtomicU32, Ordering};

/// nFAULT fell and stayed low.
pub const BRIDGE: u32 = 1 << 0;
/// nFAULT fell and rose again at once.
pub const GLITCH: u32 = 1 << 1;
/// The 3.3 V supply fell below the detector threshold.
pub const SUPPLY: u32 = 1 << 2;
/// Ctrl-C was typed.
pub const STOP: u32 = 1 << 3;
/// The button was pressed.
pub const BUTTON: u32 = 1 << 5;
/// Samples of the current were lost.
pub const OVERRUN: u32 = 1 << 7;
/// The ring of current samples has stopped and must be restarted.
pub const RESTART: u32 = 1 << 8;
/// The flash was busy, so that the processor stalled. Missed control periods are then no fault.
pub const FLASH: u32 = 1 << 9;
/// The level of nFAULT has changed.
pub const LINE: u32 = 1 << 6;
/// A byte was received with noise on the line.
pub const NOISE: u32 = 1 << 4;

static EVENTS: AtomicU32 = AtomicU32::new(0);

/// Reports an event to the control loop.
pub fn raise(event: u32) {
    EVENTS.fetch_or(event, Ordering::Relaxed);
}

/// The events reported so far. They stay reported.
#[inline]
pub fn pending() -> u32 {
    EVENTS.load(Ordering::Relaxed)
}

/// Takes the reported events and clears them.
#[inline]
pub fn take() -> u32 {
    match pending() {
        0 => 0,
        _ => EVENTS.swap(0, Ordering::Relaxed),
    }
}
