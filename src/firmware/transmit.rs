//! Order of transmission on the serial line: first rows of the stream, then text of the console, then a capture.

use haptic_paddle::telemetry::{Part, Row, ShortSample, Telemetry};
use heapless::spsc::Consumer;
use link::{Body, CHUNK_SAMPLES, Frame, SAMPLE_BYTES};
use rtic::Mutex;

use super::BAUD_WANTED;
use crate::board::serial::{CHUNK_BYTES, Transmitter};
use core::sync::atomic::Ordering;

/// Size of the row queue: 6 ms at 5 kHz, longer than the transmission of the longest chunk.
pub const ROWS: usize = 32;
/// Largest number of text bytes between two rows.
const TEXT_BYTES: usize = 64;

/// Selects and encodes what is sent next.
pub struct Sender {
    line: Transmitter,
    rows: Consumer<'static, Row>,
    text: Consumer<'static, u8>,
    sequence: u16,
}

impl Sender {
    pub fn new(
        line: Transmitter,
        rows: Consumer<'static, Row>,
        text: Consumer<'static, u8>,
    ) -> Self {
        Self {
            line,
            rows,
            text,
            sequence: 0,
        }
    }

    /// Sends the next chunk if the line is free and there is data.
    pub fn serve(&mut self, telemetry: &mut impl Mutex<T = Telemetry>) {
        let Some(chunk) = self.line.chunk() else {
            return;
        };
        let mut frames = Frames {
            chunk,
            sequence: &mut self.sequence,
        };
        let length = if let Some(row) = self.rows.dequeue() {
            frames.row(&row)
        } else if !self.text.is_empty() {
            frames.text(&mut self.text)
        } else {
            frames.capture(telemetry)
        };
        self.line.send(length);
        let wanted = BAUD_WANTED.load(Ordering::Relaxed);
        if length == 0 && wanted != 0 && self.line.change_baud(wanted) {
            BAUD_WANTED.store(0, Ordering::Relaxed);
        }
    }
}

/// Writes chunks and numbers the frames.
struct Frames<'a> {
    chunk: &'a mut [u8; CHUNK_BYTES],
    sequence: &'a mut u16,
}

impl Frames<'_> {
    fn frame(&mut self, body: Body) -> usize {
        let frame = Frame::new(*self.sequence, body);
        *self.sequence = self.sequence.wrapping_add(1);
        // A frame that does not fit would be missing in the sequence. All frames fit.
        link::encode(&frame, self.chunk).map_or(0, <[u8]>::len)
    }

    fn row(&mut self, row: &Row) -> usize {
        let mut values = [0; Row::MOST_BYTES];
        let values = row.write(&mut values);
        self.frame(Body::Row {
            period: row.period,
            dropped: row.dropped,
            channels: row.channels,
            values,
        })
    }

    fn text(&mut self, text: &mut Consumer<'static, u8>) -> usize {
        let mut length = 0;
        for place in self.chunk.iter_mut().take(TEXT_BYTES) {
            let Some(byte) = text.dequeue() else {
                break;
            };
            *place = byte;
            length += 1;
        }
        length
    }

    fn capture(&mut self, telemetry: &mut impl Mutex<T = Telemetry>) -> usize {
        let mut samples = [ShortSample::NONE; CHUNK_SAMPLES];
        match telemetry.lock(|telemetry| telemetry.capture.next_part(&mut samples)) {
            None => 0,
            Some(Part::Head(held)) => self.frame(Body::Capture {
                trigger: held.trigger,
                samples: held.samples as u16,
                triggered_at: held.triggered_at as u16,
                period: held.period,
            }),
            Some(Part::Samples { first, count }) => {
                let mut bytes = [0; CHUNK_SAMPLES * SAMPLE_BYTES];
                let (places, _) = bytes.as_chunks_mut();
                for (place, sample) in places.iter_mut().zip(samples) {
                    *place = sample.to_bytes();
                }
                self.frame(Body::Samples {
                    first: first as u16,
                    samples: bytes.get(..count * SAMPLE_BYTES).unwrap_or_default(),
                })
            }
        }
    }
}
