//! The frames that the board and a computer exchange beside the console text, on the same serial port.
//!
//! A [`Frame`] is encoded by postcard and followed by a CRC-16. COBS removes zero bytes from it, and a zero byte is added at
//! both ends. Text contains no zero byte, so a [`Splitter`] can separate both byte by byte:
//!
//! ```text
//! text ... 00 | COBS of (postcard of the frame, CRC-16) | 00 ... text
//! ```
//!
//! ```
//! use link::{Body, Channel, Channels, Frame, Heard, Splitter};
//!
//! let values = 0.25f32.to_le_bytes();
//! let channels = Channels::NONE.with(Channel::Encoder);
//! let row = Body::Row { period: 1200, dropped: 0, channels, values: &values };
//! let mut wire = [0; link::MOST_BYTES];
//! let sent = link::encode(&Frame::new(7, row), &mut wire)?;
//!
//! let mut splitter = Splitter::default();
//! let mut found = 0;
//! for byte in sent {
//!     if let Heard::Frame(frame) = splitter.push(*byte) {
//!         assert_eq!(frame.body, row);
//!         found += 1;
//!     }
//! }
//! assert_eq!(found, 1);
//! # Ok::<(), link::EncodeError>(())
//! ```
#![no_std]

mod channel;
mod frame;
mod sample;
mod sequence;
mod splitter;

pub use channel::{Channel, Channels, ChannelsError};
pub use frame::{
    Body, CHUNK_SAMPLES, EncodeError, Frame, MOST_BYTES, SAMPLE_BYTES, Trigger, VERSION, encode,
    row_bytes, values,
};
pub use sample::{Sample, ShortSample};
pub use sequence::Sequence;
pub use splitter::{Heard, Splitter};
