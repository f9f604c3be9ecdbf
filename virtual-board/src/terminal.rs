//! The terminal at the other end of the serial line.

use std::collections::VecDeque;

/// Default baud rate of the terminal, bit/s.
pub const BAUD: f64 = 460_800.0;

/// A serial terminal.
#[derive(Debug, Clone)]
pub struct Terminal {
    /// Baud rate, bit/s.
    pub baud: f64,
    typed: VecDeque<u8>,
    /// Time at which the byte on the line arrives, s.
    arrives_s: f64,
    answered: Vec<u8>,
}

impl Default for Terminal {
    fn default() -> Self {
        Self {
            baud: BAUD,
            typed: VecDeque::new(),
            arrives_s: 0.0,
            answered: Vec::new(),
        }
    }
}

impl Terminal {
    /// Sends `bytes` at time `now_s`, after bytes that are still on the line.
    pub fn send(&mut self, bytes: &[u8], now_s: f64) {
        if self.typed.is_empty() {
            self.arrives_s = self.arrives_s.max(now_s) + self.frame_s();
        }
        self.typed.extend(bytes);
    }

    /// Transmission time of a byte, s.
    fn frame_s(&self) -> f64 {
        crate::peripherals::usart::FRAME_BITS as f64 / self.baud
    }

    /// Number of bytes that have not yet arrived at the board.
    pub fn waiting(&self) -> usize {
        self.typed.len()
    }

    /// Time at which the next byte arrives at the board, s.
    pub fn next_arrival_s(&self) -> Option<f64> {
        (!self.typed.is_empty()).then_some(self.arrives_s)
    }

    /// Takes the byte that arrives now.
    pub fn arrive(&mut self) -> Option<u8> {
        let byte = self.typed.pop_front()?;
        if !self.typed.is_empty() {
            self.arrives_s += self.frame_s();
        }
        Some(byte)
    }

    /// Receives a byte from the board.
    pub fn receive(&mut self, byte: u8) {
        self.answered.push(byte);
    }

    /// Takes the bytes that the board has sent since the last call.
    pub fn take_answer(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.answered)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_arrive_one_frame_apart() {
        let mut terminal = Terminal::default();
        terminal.send(b"ab", 1.0);
        let frame_s = 10.0 / BAUD;
        assert_eq!(terminal.next_arrival_s(), Some(1.0 + frame_s));
        assert_eq!(terminal.arrive(), Some(b'a'));
        assert_eq!(terminal.next_arrival_s(), Some(1.0 + frame_s + frame_s));
        assert_eq!(terminal.arrive(), Some(b'b'));
        assert_eq!(terminal.next_arrival_s(), None);
    }

    #[test]
    fn a_busy_line_makes_the_next_byte_wait() {
        let mut terminal = Terminal::default();
        terminal.send(b"a", 1.0);
        terminal.arrive();
        terminal.send(b"b", 1.0);
        assert_eq!(
            terminal.next_arrival_s(),
            Some(1.0 + 10.0 / BAUD + 10.0 / BAUD)
        );
    }
}
