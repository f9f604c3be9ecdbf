//! Progress on standard error: the current stage, the elapsed time, and the estimated remaining time.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Work that takes less than this time shows no progress.
const PATIENCE: Duration = Duration::from_secs(2);
const TICK: Duration = Duration::from_millis(100);

/// The only progress line of the process, because there is one standard error.
static SPINNER: LazyLock<ProgressBar> = LazyLock::new(|| {
    let style = ProgressStyle::with_template("{spinner} {prefix}{msg}, {elapsed}");
    ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_message("working")
});

/// The measurable work that is in progress.
static WORK: Mutex<Option<Work>> = Mutex::new(None);

/// Work whose completed share is known.
#[derive(Clone, Copy)]
struct Work {
    begun: Instant,
    /// Completed share of the work at the time `seen`, 0 to 1.
    done: f64,
    seen: Instant,
}

impl Work {
    /// Estimated remaining time at the mean speed so far. Returns `None` as long as the share is too small for an estimate.
    fn left(&self, now: Instant) -> Option<Duration> {
        let took_s = self.seen.duration_since(self.begun).as_secs_f64();
        if self.done < LEAST_DONE || took_s == 0.0 {
            return None;
        }
        let left_s = took_s * (1.0 - self.done).max(0.0) / self.done;
        let since_s = now.duration_since(self.seen).as_secs_f64();
        Some(Duration::from_secs_f64((left_s - since_s).max(0.0).ceil()))
    }
}

/// Smallest completed share for an estimate of the remaining time.
const LEAST_DONE: f64 = 0.03;

/// Runs `work`. If it takes long, shows the elapsed time on a terminal.
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
                SPINNER.set_message(message());
                SPINNER.tick();
            }
            SPINNER.finish_and_clear();
        });
        let result = work();
        drop(working);
        result
    })
}

/// The stage that was reported last.
static DOING: Mutex<String> = Mutex::new(String::new());

/// The text of the progress line.
fn message() -> String {
    let doing = DOING.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let work = *WORK.lock().unwrap_or_else(PoisonError::into_inner);
    let doing = if doing.is_empty() {
        "working".to_owned()
    } else {
        doing
    };
    match work.and_then(|work| work.left(Instant::now())) {
        Some(left) => format!("{doing}, about {} left", HumanDuration(left)),
        None => doing,
    }
}

/// Shows which of several items is in progress.
pub fn within(which: &str) {
    SPINNER.set_prefix(format!("{which}: "));
}

/// Shows the current stage.
pub fn doing(what: String) {
    *DOING.lock().unwrap_or_else(PoisonError::into_inner) = what;
}

/// Starts the time estimate of a work whose share is reported by [`part_done`].
pub fn begin() {
    let now = Instant::now();
    let begun = Work {
        begun: now,
        done: 0.0,
        seen: now,
    };
    *WORK.lock().unwrap_or_else(PoisonError::into_inner) = Some(begun);
}

/// Reports the completed share of the work, 0 to 1.
pub fn part_done(done: f64) {
    let mut work = WORK.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(work) = work.as_mut() {
        (work.done, work.seen) = (done, Instant::now());
    }
}

/// Stops the progress line, because another program part uses the terminal.
pub fn hide() {
    SPINNER.set_draw_target(ProgressDrawTarget::hidden());
}

/// Prints a line about a finished part, if the work takes long.
pub fn done(line: &str) {
    if SPINNER.elapsed() >= PATIENCE {
        SPINNER.suspend(|| eprintln!("{line}"));
    }
}

/// Prints a line on standard error.
pub fn note(line: &str) {
    SPINNER.suspend(|| eprintln!("{line}"));
}

/// Prints a line on standard output.
pub fn say(line: &str) {
    // If standard output is closed, there is no reader.
    SPINNER.suspend(|| drop(writeln!(std::io::stdout(), "{line}")));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_follows_from_the_mean_speed_and_decreases_between_reports() {
        let begun = Instant::now();
        let seen = begun + Duration::from_secs(10);
        let work = |done| Work { begun, done, seen };
        let left = |done, later_s| {
            let left = work(done).left(seen + Duration::from_secs(later_s));
            left.map(|left| left.as_secs())
        };
        assert_eq!(left(0.25, 0), Some(30));
        assert_eq!(left(0.25, 12), Some(18));
        assert_eq!(left(0.25, 90), Some(0));
        assert_eq!(left(1.0, 0), Some(0));
        assert_eq!(left(0.001, 0), None, "too early to tell");
    }
}
