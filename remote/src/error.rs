//! Why a board does not do what it is asked.

use std::io;

/// Why.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// No such port, or not for us.
    #[error("cannot open {port}: {source}; check the name, and that no other program has it open")]
    Open {
        /// Its name.
        port: String,
        /// What the system said.
        source: serialport::Error,
    },
    /// The line broke.
    #[error("the serial line is gone: {0}; the board disarms by itself: check the cable")]
    Gone(#[from] io::Error),
    /// Nobody answers.
    #[error(
        "the board does not answer on this port; check cable and power, or press its reset button"
    )]
    Silent,
    /// The board refuses a command.
    #[error("the board refuses `{line}`: {answer}")]
    Refused {
        /// The line that was sent.
        line: String,
        /// What it said.
        answer: String,
    },
    /// A fault disarmed the board.
    #[error("the board stopped: {0}")]
    Fault(String),
    /// Frames of another version.
    #[error(
        "the board sends frames of version {sent}, this program reads version {}: flash the firmware of the same release",
        link::VERSION
    )]
    Version {
        /// The board's.
        sent: u8,
    },
    /// Rows were lost.
    #[error(
        "{lost} of {all} rows were lost on the way; ask for fewer a second, or free the computer"
    )]
    Lost {
        /// How many.
        lost: u64,
        /// Number of all.
        all: u64,
    },
    /// A run of which too little is left.
    #[error(
        "a fault ended the run after {0:.2} s, too soon to be used; ask for less, and see `faults` on the console"
    )]
    TooShort(f64),
    /// The user wants to end.
    #[error("ended, as was wished; the paddle is disarmed")]
    Ended,
}
