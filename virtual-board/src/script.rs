//! A script of typed lines and board events with their times.
//!
//! ```text
//! # seconds since power-on, then a line to type
//! 0.1  zero hall
//! 0.2  arm
//! # or, after an exclamation mark, something that happens to the board
//! 1.5  !bridge-fault on
//! 1.6  !bridge-fault off
//! 2.0  !supply-off 0.3
//! ```

use crate::board::{Board, Halt, Pause};
use crate::wiring::Wires;

/// An action of the script.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Types a line followed by the return key.
    Type(String),
    /// Pulls nFAULT of the bridge low, or releases it.
    BridgeFault(bool),
    /// Removes the supply for this time, s.
    SupplyOff(f64),
    /// Presses the reset button.
    Reset,
    /// Stops the crystal.
    CrystalStop,
    /// Changes the wiring.
    Wire(String),
}

/// A script in the order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Script {
    lines: Vec<(f64, Action)>,
}

/// Why a script cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScriptError {
    /// A line does not begin with a time.
    #[error("line {line} of the script begins with '{found}'; write seconds, then what to type")]
    Time {
        /// Line number from 1.
        line: usize,
        /// The text at that position.
        found: String,
    },
    /// A line has an earlier time than the line before.
    #[error("line {line} of the script goes back in time; put its lines in order")]
    Order {
        /// Line number from 1.
        line: usize,
    },
    /// The event is unknown.
    #[error(
        "line {line} of the script: nothing like '!{found}' happens; there are !bridge-fault on|off, \
         !supply-off SECONDS, !reset, !crystal-stop, and !wire {}",
        Wires::NAMED.map(|(name, _)| name).join("|")
    )]
    Action {
        /// Line number from 1.
        line: usize,
        /// The text at that position.
        found: String,
    },
}

impl Script {
    /// Parses a script.
    ///
    /// # Errors
    ///
    /// [`ScriptError`] with the line number.
    pub fn parse(text: &str) -> Result<Self, ScriptError> {
        let mut script = Self::default();
        for (index, words) in text.lines().enumerate() {
            let line = index + 1;
            let words = words.trim();
            if words.is_empty() || words.starts_with('#') {
                continue;
            }
            let (first, rest) = words.split_once(char::is_whitespace).unwrap_or((words, ""));
            let time_s = first
                .parse()
                .ok()
                .filter(|time_s: &f64| time_s.is_finite() && *time_s >= 0.0)
                .ok_or_else(|| ScriptError::Time {
                    line,
                    found: first.into(),
                })?;
            if script.end_s() > time_s {
                return Err(ScriptError::Order { line });
            }
            let action = match rest.trim().strip_prefix('!') {
                None => Action::Type(rest.trim().into()),
                Some(event) => Action::of(event).ok_or_else(|| ScriptError::Action {
                    line,
                    found: event.into(),
                })?,
            };
            script.lines.push((time_s, action));
        }
        Ok(script)
    }

    /// Time of the last line, s.
    pub fn end_s(&self) -> f64 {
        self.lines.last().map_or(0.0, |(time_s, _)| *time_s)
    }

    /// Runs `board` through the script and then until `until_s`. Later lines are ignored. `go_on` is called at regular
    /// intervals with the board. It returns false to stop.
    ///
    /// # Errors
    ///
    /// [`Halt`].
    pub fn run(
        &self,
        board: &mut Board,
        until_s: f64,
        go_on: &mut impl FnMut(&mut Board) -> bool,
    ) -> Result<(), Halt> {
        for (time_s, action) in &self.lines {
            if *time_s > until_s {
                break;
            }
            if !run_through(board, *time_s, go_on)? {
                return Ok(());
            }
            action.take(board);
        }
        run_through(board, until_s, go_on).map(drop)
    }
}

/// Interval between two calls of `go_on`, s of simulated time.
const LOOK_S: f64 = 0.05;

/// Runs and ignores breakpoints. Returns false if `go_on` stopped the run.
fn run_through(
    board: &mut Board,
    until_s: f64,
    go_on: &mut impl FnMut(&mut Board) -> bool,
) -> Result<bool, Halt> {
    loop {
        let look_s = (board.time_s() + LOOK_S).min(until_s);
        while board.run_until(look_s)? != Pause::Time {}
        if !go_on(board) {
            return Ok(false);
        }
        if look_s >= until_s {
            return Ok(true);
        }
    }
}

impl Action {
    fn of(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let action = match (words.next()?, words.next()) {
            ("bridge-fault", Some("on")) => Self::BridgeFault(true),
            ("bridge-fault", Some("off")) => Self::BridgeFault(false),
            ("supply-off", Some(seconds)) => Self::SupplyOff(
                seconds
                    .parse()
                    .ok()
                    .filter(|s: &f64| (0.0..=LONGEST_OUTAGE_S).contains(s))?,
            ),
            ("reset", None) => Self::Reset,
            ("crystal-stop", None) => Self::CrystalStop,
            ("wire", Some(name)) if Wires::default().change(name) => Self::Wire(name.into()),
            _ => return None,
        };
        words.next().is_none().then_some(action)
    }

    /// Applies the action to the board.
    pub fn take(&self, board: &mut Board) {
        match self {
            Self::Type(line) => board.type_in(&format!("{line}\r")),
            Self::BridgeFault(on) => board.set_bridge_fault(*on),
            Self::SupplyOff(seconds) => board.interrupt_supply(*seconds),
            Self::Reset => board.press_reset(),
            Self::CrystalStop => board.set_crystal(false),
            Self::Wire(name) => {
                board.wires_mut().change(name);
            }
        }
    }
}

const LONGEST_OUTAGE_S: f64 = 60.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_typed_and_events_take_effect() {
        let script = Script::parse(
            "# a comment\n\n0.1 zero hall\n0.1\tarm\n1.5 !bridge-fault on\n2 !supply-off 0.3\n2.5 !wire motor-cut",
        )
        .unwrap();
        assert_eq!(
            script.lines,
            [
                (0.1, Action::Type("zero hall".into())),
                (0.1, Action::Type("arm".into())),
                (1.5, Action::BridgeFault(true)),
                (2.0, Action::SupplyOff(0.3)),
                (2.5, Action::Wire("motor-cut".into())),
            ]
        );
    }

    #[test]
    fn errors_name_the_line() {
        for (text, line) in [
            ("arm", "line 1 of the script begins with 'arm'"),
            ("-1 arm", "line 1"),
            ("0.2 arm\n0.1 zero", "line 2 of the script goes back"),
            (
                "0.2 !explode",
                "line 1 of the script: nothing like '!explode'",
            ),
            ("0.2 !reset now", "line 1"),
            ("0.2 !wire blue", "line 1"),
        ] {
            let error = Script::parse(text).unwrap_err().to_string();
            assert!(error.contains(line), "{error}");
        }
    }
}
