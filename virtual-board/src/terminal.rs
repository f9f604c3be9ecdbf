//! The far end of the serial line: bytes typed, at the pace of the line, and bytes answered.

use std::collections::VecDeque;

/// Bits a second of a terminal that nobody has set otherwise.
pub const BAUD: f64 = 460_800.0;

/// A terminal.
#[derive(Debug, Clone)]
pub struct Terminal {
    /// Bits a second, as its user sets them.
    pub baud: f64,
    typed: VecDeque<u8>,
    /// Time at which the byte on the line has arrived, s.
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
    /// Types `bytes` at time `now_s`, after what is still on its way.
    pub fn send(&mut self, bytes: &[u8], now_s: f64) {
        if self.typed.is_empty() {
            self.arrives_s = self.arrives_s.max(now_s) + self.frame_s();
        }
        self.typed.extend(bytes);
    }

    /// Time of a byte on the line, s.
    fn frame_s(&self) -> f64 {
        crate::peripherals::usart::FRAME_BITS as f64 / self.baud
    }

    /// Bytes that are still to arrive at the board.
    pub fn waiting(&self) -> usize {
        self.typed.len()
    }

    /// Time at which the next byte arrives at the board, s.
    pub fn next_arrival_s(&self) -> Option<f64> {
        (!self.typed.is_empty()).then_some(self.arrives_s)
    }

    /// The byte that arrives now.
    pub fn arrive(&mut self) -> Option<u8> {
        let byte = self.typed.pop_front()?;
        if !self.typed.is_empty() {
            self.arrives_s += self.frame_s();
        }
        Some(byte)
    }

    /// Takes in what the board sent.
    pub fn receive(&mut self, byte: u8) {
        self.answered.push(byte);
    }

    /// What the board has sent since the last call.
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
