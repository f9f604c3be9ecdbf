//! Telemetry: data that the board sends to a computer beside the console text, as a stream of rows and as captures.
//!
//! ```text
//! control interrupt -> Sample -> stream  -> rows, some control periods long -> serial port
//!                             -> capture -> memory, every control period    -> serial port, on request
//! ```
//!
//! Both process a [`Sample`] every control period, directly after the control interrupt and at a lower priority.

mod capture;
mod stream;

pub use capture::{Capture, CaptureError, CapturePlan, CaptureState, Held, Part, TriggerPlan};
pub use link::{Channel, Channels, Sample, ShortSample, Trigger};
pub use stream::{Row, Stream, StreamError, StreamPlan};

use crate::procedures::Winding;

/// Largest share of the serial line for a stream. The rest is for the console.
pub const MOST_OF_THE_LINE: f32 = 0.85;
/// Bits per byte on the serial line.
pub const BITS_PER_BYTE: f32 = 10.0;

/// The telemetry of a board.
#[derive(Debug)]
pub struct Telemetry {
    /// The stream of rows.
    pub stream: Stream,
    /// The capture.
    pub capture: Capture,
    /// Winding measurement of a procedure.
    pub winding: Winding,
    /// Present baud rate of the serial line, bit/s.
    pub baud: u32,
    /// Control periods per second.
    tick_hz: f32,
}

impl Telemetry {
    /// Telemetry without a stream. Faults are captured into `memory`, one sample per control period.
    pub fn new(memory: &'static mut [ShortSample], tick_hz: f32, baud: u32) -> Self {
        Self {
            stream: Stream::default(),
            capture: Capture::new(memory),
            winding: Winding::default(),
            baud,
            tick_hz,
        }
    }

    /// Control periods per second.
    pub fn tick_hz(&self) -> f32 {
        self.tick_hz
    }

    /// Adds the sample of control period `period`. Returns a row if one is complete.
    #[inline]
    pub fn add(&mut self, period: u32, sample: &Sample) -> Option<Row> {
        self.winding.add(sample);
        self.capture.add(period, sample);
        self.stream.add(period, sample)
    }
}
