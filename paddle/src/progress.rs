//! A sign of life on standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Work that is done by then shows nothing.
const PATIENCE: Duration = Duration::from_secs(2);
const TICK: Duration = Duration::from_millis(100);

/// Does `work`, with the time that it takes shown on a terminal once it takes long.
pub fn shown<T>(work: impl FnOnce() -> T) -> T {
    let (working, done) = channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            let goes_on = |wait| done.recv_timeout(wait) == Err(RecvTimeoutError::Timeout);
            if !goes_on(PATIENCE) {
                return;
            }
            let style = ProgressStyle::with_template("{spinner} working, {elapsed}");
            let spinner = ProgressBar::new_spinner()
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
                .with_elapsed(PATIENCE);
            while goes_on(TICK) {
                spinner.tick();
            }
            spinner.finish_and_clear();
        });
        let result = work();
        drop(working);
        result
    })
}
