//! Separates received bytes into text and frames.

use crate::frame::{self, Frame, MOST_BYTES, VERSION};

/// The meaning of a received byte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard<'a> {
    /// It is part of an incomplete frame.
    Nothing,
    /// It is text.
    Text(u8),
    /// It completed a frame.
    Frame(Frame<'a>),
    /// It completed a frame of another version. Sender and receiver are not compatible.
    OtherVersion(u8),
    /// It ended bytes that are not a valid frame. Some were lost or changed.
    Corrupt,
}

/// Separates text and frames. After a lost or changed byte it is synchronised again at the second intact frame.
#[derive(Clone, Debug)]
pub struct Splitter {
    bytes: [u8; MOST_BYTES],
    /// Number of bytes of the present frame. `None` in text.
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
    /// Processes a byte.
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
                // A frame cannot be this long, so the zero byte before it was not the start of a frame.
                None => {
                    self.length = None;
                    Heard::Corrupt
                }
            };
        }
        if length == 0 {
            // Of two successive zero bytes, the second one starts the frame.
            return Heard::Nothing;
        }
        // The zero byte after invalid bytes may be the start of a frame.
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
