//! A virtual board in this process, in place of a serial port.

use std::io;

use virtual_board::board::{Board, Pause};

use crate::wire::Wire;

/// Simulated time per read without data, s.
const WAIT_S: f64 = 1e-3;

/// A line to a virtual board. The board runs while somebody reads, as fast as the computer allows. The clock of the line is
/// that of the board.
pub struct VirtualWire {
    board: Board,
    /// Bytes of the board that have not been read.
    unread: Vec<u8>,
    cut_s: f64,
}

impl VirtualWire {
    /// A line to this board.
    pub fn new(board: Board) -> Self {
        Self {
            board,
            unread: Vec::new(),
            cut_s: f64::INFINITY,
        }
    }

    /// Cuts the line at `time_s`: the board then receives nothing.
    pub fn cut_at(&mut self, time_s: f64) {
        self.cut_s = time_s;
    }
}

impl Wire for VirtualWire {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.unread.is_empty() {
            let end_s = self.board.time_s() + WAIT_S;
            while self.board.run_until(end_s).map_err(io::Error::other)? != Pause::Time {}
            self.unread = self.board.terminal.take_answer();
        }
        let length = self.unread.len().min(bytes.len());
        bytes[..length].copy_from_slice(&self.unread[..length]);
        self.unread.drain(..length);
        Ok(length)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let now_s = self.board.time_s();
        if now_s < self.cut_s {
            self.board.terminal.send(bytes, now_s);
        }
        Ok(())
    }

    fn set_baud(&mut self, baud: u32) -> io::Result<()> {
        self.board.terminal.baud = baud.into();
        Ok(())
    }

    fn time_s(&self) -> f64 {
        self.board.time_s()
    }
}
