//! The board at the pace of the clock on the wall, with its serial port as a terminal device.

use super::leave::{Session, log_line};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress;
use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};
use virtual_board::board::Board;

/// Between two looks at the terminal.
const PACE: Duration = Duration::from_millis(2);
/// A computer that is later than this does not catch up: the board's time then stands still for it, s. A program that
/// steers the board falls behind with it.
const PATIENCE_S: f64 = 0.05;
/// The board runs for so long at most between two looks at the terminal, s.
const SLICE_S: f64 = 0.005;

/// A pseudo-terminal: the board's side, and the name of the user's.
struct Terminal {
    board: File,
    /// Held open, so that a user who leaves can come back.
    _user: File,
    name: PathBuf,
}

impl Terminal {
    fn open() -> rustix::io::Result<Self> {
        let board = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&board)?;
        unlockpt(&board)?;
        let name = ptsname(&board, Vec::new())?;
        let user = rustix::fs::open(&name, OFlags::RDWR | OFlags::NOCTTY, Mode::empty())?;
        // Bytes as they are, echoed by the board alone.
        let mut settings = tcgetattr(&user)?;
        settings.make_raw();
        tcsetattr(&user, OptionalActions::Now, &settings)?;
        rustix::io::ioctl_fionbio(&board, true)?;
        Ok(Self {
            board: board.into(),
            _user: user.into(),
            name: name.to_string_lossy().into_owned().into(),
        })
    }
}

/// Runs `board` until the user wants to end, `pace` times as fast as the clock on the wall if the computer is as fast, and
/// tells `session` all along.
///
/// # Errors
/// [`Failure`] if there is no terminal device, or when the board stops.
pub fn run(
    board: &mut Board,
    header: &str,
    session: &mut Session,
    interrupt: &Interrupt,
    pace: f64,
) -> Result<(), Failure> {
    let mut terminal = Terminal::open()
        .map_err(|error| Failure::Board(format!("no pseudo-terminal to be had: {error}")))?;
    progress::doing(format!("on {}", terminal.name.display()));
    progress::say(&format!(
        "{header}serial port: {name}\n  open it with a terminal program, as in `picocom {name}`; Ctrl-C ends the board",
        name = terminal.name.display()
    ));
    let mut began = Instant::now();
    let mut began_s = board.time_s();
    let mut typed = [0; 256];
    let mut answer = Vec::new();
    while !interrupt.is_wished() {
        let mut due_s = began_s + pace * began.elapsed().as_secs_f64();
        if due_s - board.time_s() > PATIENCE_S {
            (began, began_s) = (Instant::now(), board.time_s());
            due_s = began_s;
        }
        // A pseudo-terminal has no rate of its own.
        board.terminal.baud = board.baud();
        let next_s = due_s.min(board.time_s() + SLICE_S);
        board.run_until(next_s)?;
        match terminal.board.read(&mut typed) {
            Ok(length) => {
                let now_s = board.time_s();
                board.terminal.send(&typed[..length], now_s);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(Failure::Board(format!("the terminal is gone: {error}"))),
        }
        let (said, logged) = session.take(board);
        answer.extend(said);
        // What nobody reads is lost, as on a serial line; what is read slowly waits.
        match terminal.board.write(&answer) {
            Ok(length) => drop(answer.drain(..length)),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                answer.drain(..answer.len().saturating_sub(MOST_WAITING));
            }
            Err(error) => return Err(Failure::Board(format!("the terminal is gone: {error}"))),
        }
        for entry in logged {
            progress::say(&log_line(&entry));
        }
        if next_s >= due_s {
            thread::sleep(PACE);
        }
    }
    Ok(())
}

/// Bytes kept for a terminal that reads slowly.
const MOST_WAITING: usize = 64 * 1024;
