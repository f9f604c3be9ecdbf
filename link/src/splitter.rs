//! Received bytes to text and frames.

use crate::frame::{self, Frame, MOST_BYTES, VERSION};

/// What a byte was, or completed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard<'a> {
    /// A part of a frame that is not complete.
    Nothing,
    /// A byte of text.
    Text(u8),
    /// The end of a frame.
    Frame(Frame<'a>),
    /// The end of a frame of another version: sender and receiver do not belong together.
    OtherVersion(u8),
    /// The end of bytes that are no frame: some were lost or changed on their way.
    Corrupt,
}

/// Tells text and frames apart. After a byte that was lost or changed it finds the way again with the second frame that
/// comes whole.
#[derive(Clone, Debug)]
pub struct Splitter {
    bytes: [u8; MOST_BYTES],
    /// Bytes of a frame so far; `None` in text.
    length: Option<usize>,
}

impl Default for Splitter {
    fn default() -> Self {
        Self {
            bytes: [0; MOST_BYTES],
            length: None,
        }
    }
}

impl Splitter {
    /// Takes a byte.
    pub fn push(&mut self, byte: u8) -> Heard<'_> {
        let Some(length) = self.length else {
            if byte == 0 {
                self.length = Some(0);
                return Heard::Nothing;
            }
            return Heard::Text(byte);
        };
        if byte != 0 {
            return match self.bytes.get_mut(length) {
                Some(place) => {
                    *place = byte;
                    self.length = Some(length + 1);
                    Heard::Nothing
                }
                // No frame is as long: the zero before it was none of a frame's.
                None => {
                    self.length = None;
                    Heard::Corrupt
                }
            };
        }
        if length == 0 {
            // Two zeros in a row: the second one begins.
            return Heard::Nothing;
        }
        // The zero behind bytes that are no frame may begin a frame.
        self.length = Some(0);
        let Some(frame) = self.bytes.get_mut(..length).and_then(frame::decode) else {
            return Heard::Corrupt;
        };
        self.length = None;
        if frame.version == VERSION {
            Heard::Frame(frame)
        } else {
            Heard::OtherVersion(frame.version)
        }
    }
}
