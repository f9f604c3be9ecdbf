//! The firmware's log: bytes that it leaves in a ring in RAM (RTT), and what they say (defmt).

use crate::cpu::{Memories, Width};
use crate::image::Image;
use defmt_decoder::Table;

/// A line of the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// When it was fetched, s.
    pub time_s: f64,
    /// Level in capitals; empty for a plain print.
    pub level: String,
    /// What it says.
    pub message: String,
}

/// Reads the log of an image as a debug probe does, while the program runs.
pub struct Log {
    /// Address of the control block and what decodes the frames; `None` if the image keeps no such log.
    source: Option<(u32, Table)>,
    frame: Vec<u8>,
}

/// Layout of the control block: an identification, two counts, then the channels upwards.
const IDENTIFICATION: &[u8; 10] = b"SEGGER RTT";
const FIRST_CHANNEL: u32 = 24;
const BUFFER: u32 = FIRST_CHANNEL + 4;
const SIZE: u32 = FIRST_CHANNEL + 8;
const WRITE_AT: u32 = FIRST_CHANNEL + 12;
const READ_AT: u32 = FIRST_CHANNEL + 16;

/// Ends a frame of the encoding that the firmware's logger uses.
const END_OF_FRAME: u8 = 0;

impl Log {
    /// The log of `image`.
    pub fn new(image: &Image) -> Self {
        let table = Table::parse(image.bytes()).ok().flatten();
        let block = image.symbol(|name| name == "_SEGGER_RTT");
        Self {
            source: block.map(|block| block.address).zip(table),
            frame: Vec::new(),
        }
    }

    /// Fetches what was logged, at time `now_s`.
    pub fn fetch(&mut self, memories: &mut Memories, now_s: f64, entries: &mut Vec<Entry>) {
        let Some((block, table)) = &self.source else {
            return;
        };
        let word = |memories: &Memories, offset| memories.read(block + offset, Width::Word);
        let (Some(write), Some(mut read)) = (word(memories, WRITE_AT), word(memories, READ_AT))
        else {
            return;
        };
        if write == read || !marked(memories, *block) {
            return;
        }
        let (Some(buffer), Some(size)) = (word(memories, BUFFER), word(memories, SIZE)) else {
            return;
        };
        if write >= size || read >= size {
            return;
        }
        while read != write {
            let Some(byte) = memories.read(buffer + read, Width::Byte) else {
                return;
            };
            self.frame.push(byte as u8);
            if byte as u8 == END_OF_FRAME {
                // The logger ends what may have been under way before it starts; nothing was.
                if self.frame.len() > 1 {
                    entries.push(decode(table, &self.frame, now_s));
                }
                self.frame.clear();
            }
            read = (read + 1) % size;
        }
        // The control block was read from RAM a moment ago, so that it can be written.
        let _ = memories.write(block + READ_AT, Width::Word, read);
    }

    /// Forgets a frame that a reset has cut.
    pub fn reset(&mut self) {
        self.frame.clear();
    }
}

/// Whether the program has set the control block up.
fn marked(memories: &Memories, block: u32) -> bool {
    let found = (block..).map(|address| memories.read(address, Width::Byte));
    IDENTIFICATION
        .iter()
        .zip(found)
        .all(|(expected, found)| found == Some(u32::from(*expected)))
}

fn decode(table: &Table, frame: &[u8], time_s: f64) -> Entry {
    let mut decoder = table.new_stream_decoder();
    decoder.received(frame);
    match decoder.decode() {
        Ok(frame) => Entry {
            time_s,
            level: frame
                .level()
                .map(|level| level.as_str().to_uppercase())
                .unwrap_or_default(),
            message: frame.display_message().to_string(),
        },
        Err(error) => Entry {
            time_s,
            level: "ERROR".into(),
            message: format!("a frame of the log cannot be read: {error}"),
        },
    }
}
