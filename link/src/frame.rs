//! A frame, and its bytes on the wire.

use core::fmt;

use crc::{CRC_16_IBM_SDLC, Crc, Table};
use serde::{Deserialize, Serialize};

use crate::{Channel, Channels};

/// Version of the frames' content. A receiver takes no other one.
pub const VERSION: u8 = 1;
/// Samples of a capture in one frame.
pub const CHUNK_SAMPLES: usize = 8;
/// Bytes of such a sample: eight values of 16 bits, the lower byte first.
pub const SAMPLE_BYTES: usize = 16;

/// Most bytes that a frame has before COBS: the largest body, its numbers, and the CRC.
const MOST_CONTENT: usize = CHUNK_SAMPLES * SAMPLE_BYTES + 24;
/// Most bytes of a frame on the wire, with the zero bytes at both ends.
pub const MOST_BYTES: usize = cobs::max_encoding_length(MOST_CONTENT) + 2;

pub(crate) const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_SDLC);
pub(crate) const CRC_BYTES: usize = 2;

/// One message of the board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame<'a> {
    /// [`VERSION`] of the sender.
    pub version: u8,
    /// One more than that of the frame before, modulo 65,536.
    pub sequence: u16,
    /// What it says.
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

/// What a frame says. Variants may be added at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body<'a> {
    /// A row of the stream.
    Row {
        /// Control period at which it begins, counted from the start of the board.
        period: u32,
        /// Rows of this stream that the board could not send so far.
        dropped: u32,
        /// Which values it has.
        channels: Channels,
        /// One `f32` for each channel, in their order, the lowest byte first.
        values: &'a [u8],
    },
    /// What a capture is, before its samples.
    Capture {
        /// What triggered it.
        trigger: Trigger,
        /// Samples, one a control period.
        samples: u16,
        /// Index of the sample at which the trigger came.
        triggered_at: u16,
        /// Control period of the first sample.
        period: u32,
    },
    /// Samples of a capture.
    Samples {
        /// Index of the first one.
        first: u16,
        /// [`SAMPLE_BYTES`] for each.
        samples: &'a [u8],
    },
}

/// What triggers a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trigger {
    /// A fault that is latched.
    #[default]
    Fault,
    /// A jump of the reference, as a step or a square wave makes.
    Step,
    /// A channel that passes a level.
    Level,
    /// The command itself.
    Now,
}

/// Why a frame has no bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeError;

impl fmt::Display for EncodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the frame does not fit into its buffer")
    }
}

impl core::error::Error for EncodeError {}

/// The bytes of `frame`, at the beginning of `wire`, which has room for [`MOST_BYTES`].
///
/// # Errors
/// [`EncodeError`] for a frame with more samples than [`CHUNK_SAMPLES`], or less room than it needs.
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

/// The frame of some bytes from between two zero bytes, which are overwritten.
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

/// Most bytes on the wire of a row with so many channels.
pub const fn row_bytes(channels: usize) -> usize {
    /// Version, sequence, variant, two numbers of 32 bits, the set of channels, the length of the values.
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
