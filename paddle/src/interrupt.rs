//! Interruption by the user: Ctrl-C, or a signal that asks the program to end.

use crate::failure::Failure;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that is set when the user interrupts the program. A second interruption ends the program immediately.
pub struct Interrupt(Arc<AtomicBool>);

/// Exit status after a second interruption.
const ENDED: i32 = 130;

impl Interrupt {
    /// From now on a first interruption only sets the flag.
    ///
    /// # Errors
    /// Returns [`Failure::Board`] if the signal handlers cannot be installed.
    pub fn watched() -> Result<Self, Failure> {
        let requested = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            // The order matters: at the first signal the flag is not set yet.
            flag::register_conditional_shutdown(signal, ENDED, Arc::clone(&requested))
                .and_then(|_| flag::register(signal, Arc::clone(&requested)))
                .map_err(|error| Failure::Board(format!("signals cannot be caught: {error}")))?;
        }
        Ok(Self(requested))
    }

    /// Whether the user has interrupted the program.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
