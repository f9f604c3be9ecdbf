//! The user's wish to end: Ctrl-C, or a signal that asks for it.

use crate::failure::Failure;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once the user wants to end. Who asks a second time is served at once.
pub struct Interrupt(Arc<AtomicBool>);

/// Exit status of a program that a second wish ends.
const ENDED: i32 = 130;

impl Interrupt {
    /// From now on a wish to end ends nothing by itself.
    ///
    /// # Errors
    /// [`Failure::Board`] if the system has no signals.
    pub fn watched() -> Result<Self, Failure> {
        let wished = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            // In this order: the first signal finds the flag unset.
            flag::register_conditional_shutdown(signal, ENDED, Arc::clone(&wished))
                .and_then(|_| flag::register(signal, Arc::clone(&wished)))
                .map_err(|error| Failure::Board(format!("signals cannot be caught: {error}")))?;
        }
        Ok(Self(wished))
    }

    /// Whether the user wants to end.
    pub fn is_wished(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
