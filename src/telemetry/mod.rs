//! What the board tells a computer beside the console's text: a stream of rows, and captures.
//!
//! ```text
//! control interrupt -> Sample -> stream  -> rows, some control periods long -> serial port
//!                             -> capture -> memory, every control period    -> serial port, on request
//! ```
//!
//! Both take a [`Sample`] every control period, right after the control interrupt and at a lower priority.

mod capture;
mod stream;

pub use capture::{Capture, CaptureError, CapturePlan, CaptureState, Held, Part, TriggerPlan};
pub use link::{Channel, Channels, Sample, ShortSample, Trigger};
pub use stream::{Row, Stream, StreamError, StreamPlan};

use crate::procedures::Winding;

/// Share of the serial line that a stream may take; the rest is the console's.
pub const MOST_OF_THE_LINE: f32 = 0.85;
/// Bits of a byte on the serial line.
pub const BITS_PER_BYTE: f32 = 10.0;

/// All telemetry of a board.
#[derive(Debug)]
pub struct Telemetry {
    /// Rows that are sent as they come.
    pub stream: Stream,
    /// An oscilloscope.
    pub capture: Capture,
    /// What the winding does under a periodic excitation, for its procedure.
    pub winding: Winding,
    /// Bits a second on the serial line, as they are now.
    pub baud: u32,
    /// Control periods a second.
    tick_hz: f32,
}

impl Telemetry {
    /// Nothing is sent; faults are captured into `memory`, one sample a control period.
    pub fn new(memory: &'static mut [ShortSample], tick_hz: f32, baud: u32) -> Self {
        Self {
            stream: Stream::default(),
            capture: Capture::new(memory),
            winding: Winding::default(),
            baud,
            tick_hz,
        }
    }

    /// Control periods a second.
    pub fn tick_hz(&self) -> f32 {
        self.tick_hz
    }

    /// Takes the sample of control period `period`; a row that is complete is given back.
    #[inline]
    pub fn add(&mut self, period: u32, sample: &Sample) -> Option<Row> {
        self.winding.add(sample);
        self.capture.add(period, sample);
        self.stream.add(period, sample)
    }
}
