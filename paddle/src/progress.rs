//! A sign of life on standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;
use std::sync::LazyLock;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Work that is done by then shows nothing.
const PATIENCE: Duration = Duration::from_secs(2);
const TICK: Duration = Duration::from_millis(100);

/// There is one standard error.
static SPINNER: LazyLock<ProgressBar> = LazyLock::new(|| {
    let style = ProgressStyle::with_template("{spinner} {prefix}{msg}, {elapsed}");
    ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_message("working")
});

/// Does `work`, with the time that it takes shown on a terminal once it takes long.
pub fn shown<T>(work: impl FnOnce() -> T) -> T {
    SPINNER.reset_elapsed();
    let (working, done) = channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            let goes_on = |wait| done.recv_timeout(wait) == Err(RecvTimeoutError::Timeout);
            if !goes_on(PATIENCE) {
                return;
            }
            while goes_on(TICK) {
                SPINNER.tick();
            }
            SPINNER.finish_and_clear();
        });
        let result = work();
        drop(working);
        result
    })
}

/// Says on a terminal which of many things is worked on.
pub fn within(which: &str) {
    SPINNER.set_prefix(format!("{which}: "));
}

/// Says on a terminal what is being done.
pub fn doing(what: String) {
    SPINNER.set_message(what);
}

/// Leaves a line about a part that is done, once the whole takes long.
pub fn done(line: &str) {
    if SPINNER.elapsed() >= PATIENCE {
        SPINNER.suspend(|| eprintln!("{line}"));
    }
}

/// Leaves a line on standard output.
pub fn say(line: &str) {
    // Nobody is left to be told if standard output is closed.
    SPINNER.suspend(|| drop(writeln!(std::io::stdout(), "{line}")));
}
