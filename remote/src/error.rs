//! Errors of the communication with a board.

use std::io;

/// Why a board could not be used.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// The port does not exist or cannot be opened.
    #[error("cannot open {port}: {source}; check the name, and that no other program has it open")]
    Open {
        /// Name of the port.
        port: String,
        /// The error of the operating system.
        source: serialport::Error,
    },
    /// The serial line is broken.
    #[error("the serial line is gone: {0}; the board disarms by itself: check the cable")]
    Gone(#[from] io::Error),
    /// No board answers.
    #[error(
        "the board does not answer on this port; check cable and power, or press its reset button"
    )]
    Silent,
    /// The board refuses a command.
    #[error("the board refuses `{line}`: {answer}")]
    Refused {
        /// The line that was sent.
        line: String,
        /// The answer of the board.
        answer: String,
    },
    /// A fault disarmed the board.
    #[error("the board stopped: {0}")]
    Fault(String),
    /// The board sends frames of another version.
    #[error(
        "the board sends frames of version {sent}, this program reads version {}: flash the firmware of the same release",
        link::VERSION
    )]
    Version {
        /// Version of the board.
        sent: u8,
    },
    /// Rows were lost.
    #[error(
        "{lost} of {all} rows were lost on the way; ask for fewer a second, or free the computer"
    )]
    Lost {
        /// Number of lost rows.
        lost: u64,
        /// Number of all rows.
        all: u64,
    },
    /// Too little is left of a run.
    #[error(
        "a fault ended the run after {0:.2} s, too soon to be used; ask for less, and see `faults` on the console"
    )]
    TooShort(f64),
    /// The user stopped the program.
    #[error("stopped by the user; the paddle is disarmed")]
    Ended,
}
