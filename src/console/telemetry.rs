//! The console commands of the telemetry: `stream`, `capture` and `baud`.

use core::fmt;

use super::Device;
use super::command::{Arguments, ParseError};
use crate::decimal::Decimal;
use crate::telemetry::{
    CaptureError, CapturePlan, CaptureState, Channel, Channels, StreamError, StreamPlan, Trigger,
    TriggerPlan,
};

/// Lowest and highest baud rate of the serial line, bit/s. Above the highest, the resolution of the clock divider is too
/// coarse.
const BAUDS: core::ops::RangeInclusive<u32> = 9_600..=2_000_000;
/// Default time before the trigger of a capture, ms.
const BEFORE_MS: f32 = 25.0;

/// A telemetry command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TelemetryCommand {
    /// Show the state of the stream.
    ShowStream,
    /// Stream these channels at this rate, Hz.
    Stream(Channels, f32),
    /// Stop the stream.
    EndStream,
    /// Show the state of the capture.
    ShowCapture,
    /// Start a capture with this time before its trigger, ms. For a fault trigger the default is the whole memory.
    Capture(TriggerPlan, Option<f32>),
    /// Send the complete capture.
    SendCapture,
}

/// Parses the words after `stream`.
pub(super) fn stream(arguments: &mut Arguments) -> Result<TelemetryCommand, ParseError> {
    Ok(match arguments.optional() {
        None => TelemetryCommand::ShowStream,
        Some("off") => TelemetryCommand::EndStream,
        Some(names) => {
            let channels = Channels::parse(names).map_err(|_| ParseError::UnknownChannel)?;
            TelemetryCommand::Stream(channels, arguments.number()?)
        }
    })
}

/// Parses the words after `capture`.
pub(super) fn capture(arguments: &mut Arguments) -> Result<TelemetryCommand, ParseError> {
    let trigger = match arguments.optional() {
        None => return Ok(TelemetryCommand::ShowCapture),
        Some("send") => return Ok(TelemetryCommand::SendCapture),
        Some("fault") => TriggerPlan::Fault,
        Some("step") => TriggerPlan::Step,
        Some("now") => TriggerPlan::Now,
        Some(name) => {
            let channel = Channel::named(name).ok_or(ParseError::UnknownChannel)?;
            TriggerPlan::Level(channel, arguments.number()?)
        }
    };
    let before_ms = arguments
        .optional()
        .map(|word| arguments.finite(word))
        .transpose()?;
    if before_ms.is_some_and(|ms| ms < 0.0) {
        return Err(arguments.misused());
    }
    Ok(TelemetryCommand::Capture(trigger, before_ms))
}

/// Parses the word after `baud`.
pub(super) fn baud(arguments: &mut Arguments) -> Result<u32, ParseError> {
    let baud = arguments.number()? as u32;
    if BAUDS.contains(&baud) {
        Ok(baud)
    } else {
        Err(arguments.misused())
    }
}

/// Executes a telemetry command.
pub(super) fn execute(
    wanted: TelemetryCommand,
    lender: &mut impl Device,
) -> Result<TelemetryAnswer, TelemetryRefusal> {
    lender
        .telemetry(|telemetry| {
            match wanted {
                TelemetryCommand::ShowStream => {}
                TelemetryCommand::Stream(channels, rate_hz) => {
                    let plan =
                        StreamPlan::new(channels, rate_hz, telemetry.tick_hz(), telemetry.baud)?;
                    telemetry.stream.set(Some(plan));
                }
                TelemetryCommand::EndStream => {
                    let dropped = telemetry.stream.dropped();
                    telemetry.stream.set(None);
                    return Ok(TelemetryAnswer::Stream(None, dropped));
                }
                TelemetryCommand::ShowCapture => {
                    return Ok(TelemetryAnswer::Capture(telemetry.capture.state()));
                }
                TelemetryCommand::Capture(trigger, before_ms) => {
                    let plan = match (trigger, before_ms) {
                        (TriggerPlan::Fault, None) => telemetry.capture.for_faults(),
                        (trigger, before_ms) => CapturePlan {
                            trigger,
                            before: (before_ms.unwrap_or(BEFORE_MS) * 1e-3 * telemetry.tick_hz())
                                as usize,
                        },
                    };
                    telemetry.capture.start(plan)?;
                    return Ok(TelemetryAnswer::Capture(telemetry.capture.state()));
                }
                TelemetryCommand::SendCapture => {
                    telemetry.capture.send()?;
                    return Ok(TelemetryAnswer::Capture(telemetry.capture.state()));
                }
            }
            let rate = telemetry.stream.plan().map(|plan| {
                (
                    plan.channels(),
                    telemetry.tick_hz() / plan.periods_per_row() as f32,
                )
            });
            Ok(TelemetryAnswer::Stream(rate, telemetry.stream.dropped()))
        })
        .unwrap_or(Err(TelemetryRefusal::None))
}

/// State of the telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TelemetryAnswer {
    /// The streamed channels and their rate in Hz, or `None`, and the number of dropped rows.
    Stream(Option<(Channels, f32)>, u32),
    /// State of the capture.
    Capture(CaptureState),
}

impl fmt::Display for TelemetryAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(Some((channels, rate_hz)), dropped) => {
                write!(
                    f,
                    "stream {channels} at {} Hz, {dropped} rows lost",
                    Decimal(*rate_hz)
                )
            }
            Self::Stream(None, dropped) => write!(f, "no stream, {dropped} rows lost"),
            Self::Capture(CaptureState::Waits(plan)) => match plan {
                TriggerPlan::Level(channel, level) => {
                    write!(
                        f,
                        "capture waits for {} to pass {}",
                        channel.name(),
                        Decimal(*level)
                    )
                }
                plan => write!(f, "capture waits for {}", name(plan.kind())),
            },
            Self::Capture(CaptureState::Fills(trigger)) => {
                write!(f, "capture goes on, triggered by {}", name(*trigger))
            }
            Self::Capture(CaptureState::Holds(held)) => write!(
                f,
                "capture complete, triggered by {} after {} of {} samples; capture send gives it",
                name(held.trigger),
                held.triggered_at,
                held.samples
            ),
        }
    }
}

fn name(trigger: Trigger) -> &'static str {
    match trigger {
        Trigger::Fault => "a fault",
        Trigger::Step => "a step",
        Trigger::Level => "a level",
        Trigger::Now => "the command",
    }
}

/// Why a telemetry command is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TelemetryRefusal {
    /// The device has no telemetry.
    None,
    /// The stream is refused.
    Stream(StreamError),
    /// The capture is refused.
    Capture(CaptureError),
}

impl fmt::Display for TelemetryRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("no telemetry here"),
            Self::Stream(error) => error.fmt(f),
            Self::Capture(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for TelemetryRefusal {}

impl From<StreamError> for TelemetryRefusal {
    fn from(error: StreamError) -> Self {
        Self::Stream(error)
    }
}

impl From<CaptureError> for TelemetryRefusal {
    fn from(error: CaptureError) -> Self {
        Self::Capture(error)
    }
}
