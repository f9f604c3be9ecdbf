//! The firmware's log: defmt frames in an RTT ring buffer in RAM.

use crate::cpu::{Memories, Width};
use crate::image::Image;
use defmt_decoder::Table;

/// One entry of the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Time at which it was read, s.
    pub time_s: f64,
    /// Level in capitals. Empty for a plain print.
    pub level: String,
    /// The message.
    pub message: String,
}

/// Reads the log of an image while the program runs, as a debug probe does.
pub struct Log {
    /// Address of the control block and table of log messages. `None` if the image has no such log.
    source: Option<(u32, Table)>,
    frame: Vec<u8>,
}

/// Identification at the start of the control block. Two counts and the up-channels follow.
const IDENTIFICATION: &[u8; 10] = b"SEGGER RTT";
const FIRST_CHANNEL: u32 = 24;
const BUFFER: u32 = FIRST_CHANNEL + 4;
const SIZE: u32 = FIRST_CHANNEL + 8;
const WRITE_AT: u32 = FIRST_CHANNEL + 12;
const READ_AT: u32 = FIRST_CHANNEL + 16;

/// End of a frame in the encoding of the firmware's logger.
const END_OF_FRAME: u8 = 0;

impl Log {
    /// A reader for the log of `image`.
    pub fn new(image: &Image) -> Self {
        let table = Table::parse(image.bytes()).ok().flatten();
        let block = image.symbol(|name| name == "_SEGGER_RTT");
        Self {
            source: block.map(|block| block.address).zip(table),
            frame: Vec::new(),
        }
    }

    /// Reads new log entries at time `now_s`.
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
                // The logger can write an end mark before a frame. The empty frame that results is ignored.
                if self.frame.len() > 1 {
                    entries.push(decode(table, &self.frame, now_s));
                }
                self.frame.clear();
            }
            read = (read + 1) % size;
        }
        // The control block is in RAM, because it was just read, so this write cannot fail.
        let _ = memories.write(block + READ_AT, Width::Word, read);
    }

    /// Discards a frame that a reset has interrupted.
    pub fn reset(&mut self) {
        self.frame.clear();
    }
}

/// Returns true if the program has initialised the control block.
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
