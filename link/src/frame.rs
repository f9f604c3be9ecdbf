//! A frame and its encoding.

use core::fmt;

use crc::{CRC_16_IBM_SDLC, Crc, Table};
use serde::{Deserialize, Serialize};

use crate::{Channel, Channels};

/// Version of the frames. A receiver accepts no other version.
pub const VERSION: u8 = 1;
/// Number of capture samples in one frame.
pub const CHUNK_SAMPLES: usize = 8;
/// Bytes per sample: eight values of 16 bits, low byte first.
pub const SAMPLE_BYTES: usize = 16;

/// Largest size of a frame before COBS: the largest body, its numbers, and the CRC.
const MOST_CONTENT: usize = CHUNK_SAMPLES * SAMPLE_BYTES + 24;
/// Largest size of an encoded frame including the zero bytes at both ends.
pub const MOST_BYTES: usize = cobs::max_encoding_length(MOST_CONTENT) + 2;

pub(crate) const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_SDLC);
pub(crate) const CRC_BYTES: usize = 2;

/// A message of the board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame<'a> {
    /// [`VERSION`] of the sender.
    pub version: u8,
    /// Number of the frame: one more than that of the previous frame, modulo 65,536.
    pub sequence: u16,
    /// The content.
    #[serde(borrow)]
    pub body: Body<'a>,
}

impl<'a> Frame<'a> {
    /// A frame of this version.
    pub const fn new(sequence: u16, body: Body<'a>) -> Self {
        Self {
            version: VERSION,
            sequence,
            body,
        }
    }
}

/// The content of a frame. Variants may only be added at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body<'a> {
    /// A row of the stream.
    Row {
        /// Control period at its beginning, counted since boot.
        period: u32,
        /// Number of rows of this stream that the board could not send so far.
        dropped: u32,
        /// The channels with values.
        channels: Channels,
        /// One `f32` per channel in their order, low byte first.
        values: &'a [u8],
    },
    /// Properties of a capture, sent before its samples.
    Capture {
        /// The trigger that occurred.
        trigger: Trigger,
        /// Number of samples, one per control period.
        samples: u16,
        /// Index of the sample at the trigger.
        triggered_at: u16,
        /// Control period of the first sample.
        period: u32,
    },
    /// Samples of a capture.
    Samples {
        /// Index of the first sample.
        first: u16,
        /// [`SAMPLE_BYTES`] bytes per sample.
        samples: &'a [u8],
    },
}

/// Trigger of a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trigger {
    /// A fault was latched.
    #[default]
    Fault,
    /// The reference jumped, for example by a step or a square wave.
    Step,
    /// A channel crossed a level.
    Level,
    /// The command triggered it at once.
    Now,
}

/// The frame cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeError;

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the frame does not fit into its buffer")
    }
}

impl core::error::Error for EncodeError {}

/// Encodes `frame` at the beginning of `wire`, which should have [`MOST_BYTES`].
///
/// # Errors
///
/// [`EncodeError`] for a frame with more than [`CHUNK_SAMPLES`] samples, or if `wire` is too short.
pub fn encode<'w>(frame: &Frame, wire: &'w mut [u8]) -> Result<&'w [u8], EncodeError> {
    let mut content = [0; MOST_CONTENT];
    let length = postcard::to_slice(frame, &mut content)
        .map_err(|_| EncodeError)?
        .len();
    let (message, rest) = content.split_at_mut_checked(length).ok_or(EncodeError)?;
    let check = CRC.checksum(message).to_le_bytes();
    rest.get_mut(..CRC_BYTES)
        .ok_or(EncodeError)?
        .copy_from_slice(&check);
    let content = content.get(..length + CRC_BYTES).ok_or(EncodeError)?;

    let (first, rest) = wire.split_first_mut().ok_or(EncodeError)?;
    *first = 0;
    let encoded = cobs::try_encode(content, rest).map_err(|_| EncodeError)?;
    *rest.get_mut(encoded).ok_or(EncodeError)? = 0;
    wire.get(..encoded + 2).ok_or(EncodeError)
}

/// Decodes the bytes between two zero bytes. They are overwritten.
pub(crate) fn decode(encoded: &mut [u8]) -> Option<Frame<'_>> {
    let length = cobs::decode_in_place(encoded).ok()?;
    let (message, check) = encoded
        .get(..length)?
        .split_at_checked(length.checked_sub(CRC_BYTES)?)?;
    if check != CRC.checksum(message).to_le_bytes() {
        return None;
    }
    let (frame, rest): (Frame<'_>, _) = postcard::take_from_bytes(message).ok()?;
    rest.is_empty().then_some(frame)
}

/// Largest size of the encoded row with this number of channels, bytes.
pub const fn row_bytes(channels: usize) -> usize {
    /// Version, sequence number, variant, two 32-bit numbers, the set of channels, and the length of the values.
    const NUMBERS: usize = 1 + 3 + 1 + 5 + 5 + 3 + 1;
    cobs::max_encoding_length(NUMBERS + 4 * channels + CRC_BYTES) + 2
}

/// The values of a row with their channels.
pub fn values(channels: Channels, values: &[u8]) -> impl Iterator<Item = (Channel, f32)> {
    let (words, _) = values.as_chunks();
    channels
        .iter()
        .zip(words.iter().map(|bytes| f32::from_le_bytes(*bytes)))
}
