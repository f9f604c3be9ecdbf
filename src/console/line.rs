//! Typed bytes to lines.

use super::MAX_LINE_BYTES;

const BACKSPACE: u8 = 0x08;
const DELETE: u8 = 0x7F;
/// Ctrl-C, which stops everything at once.
pub const STOP_BYTE: u8 = 0x03;
/// Ctrl-C and Ctrl-U, by which terminals drop a line.
const DROP_LINE: [u8; 2] = [STOP_BYTE, 0x15];

/// What a byte did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Typed<'a> {
    /// Joined the line; to be echoed.
    Added(u8),
    /// Took the last byte of the line away.
    Erased,
    /// Ended this line.
    Line(&'a [u8]),
    /// Ended a line that was too long.
    TooLong,
    /// Dropped the line.
    Dropped,
    /// Nothing.
    Ignored,
}

/// The line that is being typed.
#[derive(Clone, Debug)]
pub struct LineEditor {
    bytes: [u8; MAX_LINE_BYTES],
    length: usize,
    too_long: bool,
    ended: bool,
    after_return: bool,
}

impl Default for LineEditor {
    fn default() -> Self {
        Self {
            bytes: [0; MAX_LINE_BYTES],
            length: 0,
            too_long: false,
            ended: false,
            after_return: false,
        }
    }
}

impl LineEditor {
    /// Takes a byte. A line ends with CR, LF or both.
    pub fn push(&mut self, byte: u8) -> Typed<'_> {
        if self.ended {
            self.clear();
        }
        let second_of_pair = self.after_return && byte == b'\n';
        self.after_return = byte == b'\r';
        match byte {
            b'\n' if second_of_pair => Typed::Ignored,
            b'\r' | b'\n' => {
                self.ended = true;
                if self.too_long {
                    Typed::TooLong
                } else {
                    Typed::Line(self.bytes.get(..self.length).unwrap_or_default())
                }
            }
            BACKSPACE | DELETE => match self.length.checked_sub(1) {
                Some(shorter) if !self.too_long => {
                    self.length = shorter;
                    Typed::Erased
                }
                _ => Typed::Ignored,
            },
            _ if DROP_LINE.contains(&byte) => {
                self.clear();
                Typed::Dropped
            }
            _ => match self.bytes.get_mut(self.length) {
                Some(slot) => {
                    *slot = byte;
                    self.length += 1;
                    Typed::Added(byte)
                }
                None => {
                    self.too_long = true;
                    Typed::Ignored
                }
            },
        }
    }

    fn clear(&mut self) {
        self.length = 0;
        self.too_long = false;
        self.ended = false;
    }
}
