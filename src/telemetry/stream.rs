//! A stream: rows of selected channels at a constant rate.

use core::fmt;

use link::{Channel, Channels, Sample};

use super::{BITS_PER_BYTE, MOST_OF_THE_LINE};

/// Settings of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamPlan {
    channels: Channels,
    periods_per_row: u32,
}

impl StreamPlan {
    /// Rows of `channels` at `rate_hz`, from a loop of `tick_hz` over a serial line of `baud` bit/s.
    ///
    /// # Errors
    ///
    /// [`StreamError`] without channels, for a rate that does not divide that of the loop, or for more data than the line
    /// can carry.
    pub fn new(
        channels: Channels,
        rate_hz: f32,
        tick_hz: f32,
        baud: u32,
    ) -> Result<Self, StreamError> {
        if channels.is_empty() {
            return Err(StreamError::NoChannel);
        }
        let periods = tick_hz / rate_hz;
        // This form is false for NaN.
        if !(periods >= 1.0 && periods <= tick_hz) {
            return Err(StreamError::Rate);
        }
        let periods_per_row = (periods + 0.5) as u32;
        if (periods_per_row as f32 * rate_hz - tick_hz).abs() > 1e-3 * tick_hz {
            return Err(StreamError::Rate);
        }
        let row_bytes = link::row_bytes(channels.len()) as f32;
        let most_hz = MOST_OF_THE_LINE * baud as f32 / BITS_PER_BYTE / row_bytes;
        if rate_hz > most_hz {
            return Err(StreamError::Line {
                most_hz: most_hz as u32,
            });
        }
        Ok(Self {
            channels,
            periods_per_row,
        })
    }

    /// The streamed channels.
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// Number of control periods per row.
    pub fn periods_per_row(&self) -> u32 {
        self.periods_per_row
    }
}

/// Why a stream is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamError {
    /// No channel is selected.
    NoChannel,
    /// The rate of the loop is not a multiple of the requested rate.
    Rate,
    /// The serial line is too slow.
    Line {
        /// Largest possible rate for these channels, rows per second.
        most_hz: u32,
    },
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoChannel => f.write_str("name at least one channel"),
            Self::Rate => f.write_str(
                "the rate must divide the control loop's 20000 Hz, as 1000, 2000, 4000 or 5000 do",
            ),
            Self::Line { most_hz } => write!(
                f,
                "the serial line carries {most_hz} rows a second of these channels: ask for less, or for a faster line \
                 with baud"
            ),
        }
    }
}

impl core::error::Error for StreamError {}

/// A row: the sample at its beginning, with means over the row for the channels that need them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Control period of its beginning.
    pub period: u32,
    /// Number of dropped rows before it.
    pub dropped: u32,
    /// The selected channels.
    pub channels: Channels,
    sample: Sample,
}

impl Row {
    /// Largest number of bytes of the values.
    pub const MOST_BYTES: usize = 4 * Channel::ALL.len();

    /// The values as they are sent.
    pub fn write<'b>(&self, bytes: &'b mut [u8; Self::MOST_BYTES]) -> &'b [u8] {
        let (places, _) = bytes.as_chunks_mut();
        for (place, channel) in places.iter_mut().zip(self.channels.iter()) {
            *place = self.sample.value(channel).to_le_bytes();
        }
        bytes.get(..4 * self.channels.len()).unwrap_or_default()
    }
}

/// Builds rows from samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stream {
    plan: Option<StreamPlan>,
    /// The row that is being built.
    begun: Option<Begun>,
    dropped: u32,
}

#[derive(Clone, Copy, Debug)]
struct Begun {
    period: u32,
    sample: Sample,
    torque_sum_nm: f32,
    duty_sum: f32,
    periods: u32,
}

impl Stream {
    /// Starts or stops the stream.
    pub fn set(&mut self, plan: Option<StreamPlan>) {
        *self = Self {
            plan,
            begun: None,
            dropped: 0,
        };
    }

    /// Settings of the running stream, if any.
    pub fn plan(&self) -> Option<StreamPlan> {
        self.plan
    }

    /// Counts a row that was dropped.
    pub fn drop_row(&mut self) {
        self.dropped = self.dropped.wrapping_add(1);
    }

    /// Number of dropped rows of this stream.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Adds the sample of control period `period`. Rows begin at multiples of their length. The first sample after a row
    /// returns that row. If samples are missing, a mean uses the available ones.
    #[inline]
    pub fn add(&mut self, period: u32, sample: &Sample) -> Option<Row> {
        let plan = self.plan?;
        let length = plan.periods_per_row;
        match &mut self.begun {
            Some(begun) if period.wrapping_sub(begun.period) < length => {
                begun.torque_sum_nm += sample.torque_nm;
                begun.duty_sum += sample.duty;
                begun.periods += 1;
                None
            }
            begun => {
                if begun.is_none() && !period.is_multiple_of(length) {
                    return None;
                }
                let late = begun
                    .as_ref()
                    .map_or(0, |begun| period.wrapping_sub(begun.period) % length);
                let next = Begun {
                    period: period.wrapping_sub(late),
                    sample: *sample,
                    torque_sum_nm: sample.torque_nm,
                    duty_sum: sample.duty,
                    periods: 1,
                };
                let complete = begun.replace(next)?;
                let share = 1.0 / complete.periods as f32;
                Some(Row {
                    period: complete.period,
                    dropped: self.dropped,
                    channels: plan.channels,
                    sample: Sample {
                        torque_nm: complete.torque_sum_nm * share,
                        duty: complete.duty_sum * share,
                        ..complete.sample
                    },
                })
            }
        }
    }
}
