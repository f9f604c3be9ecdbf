//! A sign of life on standard error: what is being done, for how long, and how long it may still take.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

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

/// A stage, the part of it that is done, and its start.
static WORK: Mutex<Option<Work>> = Mutex::new(None);

/// Work of which it is known how much of it is done.
#[derive(Clone, Copy)]
struct Work {
    begun: Instant,
    /// Share of the whole that was done at the time `seen`, 0 to 1.
    done: f64,
    seen: Instant,
}

impl Work {
    /// How long it will still take at the pace up to now; none as long as that says nothing.
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

/// Share of a work from which on it tells of the rest.
const LEAST_DONE: f64 = 0.03;

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

/// What is shown now.
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

/// Says on a terminal which of many things is worked on.
pub fn within(which: &str) {
    SPINNER.set_prefix(format!("{which}: "));
}

/// Says on a terminal what is being done.
pub fn doing(what: String) {
    *DOING.lock().unwrap_or_else(PoisonError::into_inner) = what;
}

/// Begins a work of which [`part_done`] will tell how much is done.
pub fn begin() {
    let now = Instant::now();
    let begun = Work {
        begun: now,
        done: 0.0,
        seen: now,
    };
    *WORK.lock().unwrap_or_else(PoisonError::into_inner) = Some(begun);
}

/// Says how much of the work that was begun last is done, 0 to 1.
pub fn part_done(done: f64) {
    let mut work = WORK.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(work) = work.as_mut() {
        (work.done, work.seen) = (done, Instant::now());
    }
}

/// From now on shows nothing: the terminal is somebody else's.
pub fn hide() {
    SPINNER.set_draw_target(ProgressDrawTarget::hidden());
}

/// Leaves a line about a part that is done, once the whole takes long.
pub fn done(line: &str) {
    if SPINNER.elapsed() >= PATIENCE {
        SPINNER.suspend(|| eprintln!("{line}"));
    }
}

/// Leaves a line on standard error, as something takes long.
pub fn note(line: &str) {
    SPINNER.suspend(|| eprintln!("{line}"));
}

/// Leaves a line on standard output.
pub fn say(line: &str) {
    // Nobody is left to be told if standard output is closed.
    SPINNER.suspend(|| drop(writeln!(std::io::stdout(), "{line}")));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_goes_by_the_pace_and_runs_down_between_two_looks() {
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
