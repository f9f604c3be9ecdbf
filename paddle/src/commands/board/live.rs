//! Runs the board in real time, with its serial port as a pseudo-terminal.

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

/// Wall-clock time between two polls of the terminal.
const PACE: Duration = Duration::from_millis(2);
/// Largest lag behind the wall clock that is caught up, s. If the computer falls further behind, the simulated time is
/// delayed by the rest. A program that controls the board is then delayed by the same time.
const PATIENCE_S: f64 = 0.05;
/// Longest simulated time between two polls of the terminal, s.
const SLICE_S: f64 = 0.005;

/// A pseudo-terminal: the file of the board's side, and the device name of the user's side.
struct Terminal {
    board: File,
    /// The user's side stays open, so that a user can disconnect and connect again.
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
        // The terminal passes bytes unchanged and does not echo them, because the board echoes.
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

/// Runs `board` until the user interrupts it, at `pace` times real time if the computer is fast enough. Passes the board's
/// output to `session` throughout.
///
/// # Errors
/// Returns a [`Failure`] if no pseudo-terminal is available, or when the board stops.
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
    while !interrupt.is_requested() {
        let mut due_s = began_s + pace * began.elapsed().as_secs_f64();
        if due_s - board.time_s() > PATIENCE_S {
            (began, began_s) = (Instant::now(), board.time_s());
            due_s = began_s;
        }
        // A pseudo-terminal has no baud rate, so the terminal takes the baud rate of the board.
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
        // If no program has opened the terminal, the bytes are lost, as on a serial line. If the program reads slowly, the
        // bytes wait.
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

/// Largest number of bytes that wait for a slow reader.
const MOST_WAITING: usize = 64 * 1024;
