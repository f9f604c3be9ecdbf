//! An oscilloscope: it stores every control period around a trigger.

use core::fmt;

use link::{Channel, Sample, ShortSample, Trigger};

use crate::controller::Mode;

/// Trigger condition of a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TriggerPlan {
    /// A fault is latched.
    #[default]
    Fault,
    /// The reference jumps.
    Step,
    /// A channel crosses a value, in its unit, in either direction.
    Level(Channel, f32),
    /// The capture starts at once.
    Now,
}

impl TriggerPlan {
    /// Kind of the trigger.
    pub fn kind(&self) -> Trigger {
        match self {
            Self::Fault => Trigger::Fault,
            Self::Step => Trigger::Step,
            Self::Level(..) => Trigger::Level,
            Self::Now => Trigger::Now,
        }
    }
}

/// Settings of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturePlan {
    /// Trigger condition.
    pub trigger: TriggerPlan,
    /// Number of samples before the trigger.
    pub before: usize,
}

/// State of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CaptureState {
    /// It waits for its trigger.
    Waits(TriggerPlan),
    /// It stores the samples after its trigger.
    Fills(Trigger),
    /// It is complete and is kept until the next one is started.
    Holds(Held),
}

/// Properties of a complete capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// The trigger that occurred.
    pub trigger: Trigger,
    /// Number of samples.
    pub samples: usize,
    /// Index of the sample at the trigger.
    pub triggered_at: usize,
    /// Control period of the first sample.
    pub period: u32,
}

/// Why a capture cannot be started or sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureError {
    /// The capture is not complete.
    NotComplete,
    /// More samples before the trigger were requested than fit into the memory.
    TooLong {
        /// Largest possible number.
        most: usize,
    },
}

impl fmt::Display for CaptureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotComplete => f.write_str(
                "nothing is captured yet: capture shows what it waits for, capture now takes what there is",
            ),
            Self::TooLong { most } => write!(
                f,
                "the memory holds {} ms: ask for less before the trigger",
                most / 20
            ),
        }
    }
}

impl core::error::Error for CaptureError {}

/// Change from one sample to the next that counts as a jump of the reference, rad (0.1°).
const JUMP_RAD: f32 = 1.745e-3;
/// The same for a reference torque, N m at the motor.
const JUMP_NM: f32 = 1e-4;

/// Samples after the trigger of a fault's capture: ten milliseconds at 20 kHz. Most of the memory holds the time before the
/// fault.
const AFTER_FAULT: usize = 200;

/// A ring of samples with a trigger. By default it waits for a fault.
#[derive(Debug)]
pub struct Capture {
    ring: &'static mut [ShortSample],
    /// Index of the next sample.
    /// Number of stored samples.
    head: usize,
    filled: usize,
    before: usize,
    state: State,
    last: Sample,
    /// Progress of sending a complete capture.
    sending: Sending,
}

/// A part of a complete capture for sending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The properties of the capture.
    Head(Held),
    /// Some samples.
    Samples {
        /// Index of the first sample.
        first: usize,
        /// Number of samples.
        count: usize,
    },
}

#[derive(Clone, Copy, Debug)]
enum Sending {
    Nothing,
    Head,
    Samples(usize),
}

#[derive(Clone, Copy, Debug)]
enum State {
    Waits(TriggerPlan),
    Fills { held: Held, left: usize },
    Holds(Held),
}

impl Capture {
    /// A capture that waits for a fault.
    pub fn new(ring: &'static mut [ShortSample]) -> Self {
        let before = ring.len().saturating_sub(AFTER_FAULT);
        Self {
            ring,
            head: 0,
            filled: 0,
            before,
            state: State::Waits(TriggerPlan::Fault),
            last: Sample::default(),
            sending: Sending::Nothing,
        }
    }

    /// Largest number of samples of a capture.
    pub fn capacity(&self) -> usize {
        self.ring.len()
    }

    /// Settings for the capture of a fault.
    pub fn for_faults(&self) -> CapturePlan {
        CapturePlan {
            trigger: TriggerPlan::Fault,
            before: self.ring.len().saturating_sub(AFTER_FAULT),
        }
    }

    /// Starts a capture and discards the old one. A trigger can occur at once. Fewer samples than requested may then be
    /// stored before it.
    ///
    /// # Errors
    ///
    /// [`CaptureError::TooLong`] if the samples before the trigger do not fit into the memory.
    pub fn start(&mut self, plan: CapturePlan) -> Result<(), CaptureError> {
        if plan.before >= self.ring.len() {
            return Err(CaptureError::TooLong {
                most: self.ring.len(),
            });
        }
        self.before = plan.before;
        if matches!(self.state, State::Holds(_)) {
            self.filled = 0;
        }
        self.sending = Sending::Nothing;
        self.state = State::Waits(plan.trigger);
        Ok(())
    }

    /// State of the capture.
    pub fn state(&self) -> CaptureState {
        match self.state {
            State::Waits(trigger) => CaptureState::Waits(trigger),
            State::Fills { held, .. } => CaptureState::Fills(held.trigger),
            State::Holds(held) => CaptureState::Holds(held),
        }
    }

    /// Adds the sample of control period `period`.
    #[inline]
    pub fn add(&mut self, period: u32, sample: &Sample) {
        if matches!(self.state, State::Holds(_)) {
            return;
        }
        if let Some(place) = self.ring.get_mut(self.head) {
            *place = ShortSample::from(sample);
        }
        self.head += 1;
        if self.head >= self.ring.len() {
            self.head = 0;
        }
        if self.filled < self.ring.len() {
            self.filled += 1;
        }
        // The first sample has no predecessor for comparison.
        if self.filled > 1 {
            self.decide(period, sample);
        }
        self.last = *sample;
    }

    #[inline]
    fn decide(&mut self, period: u32, sample: &Sample) {
        match &mut self.state {
            State::Waits(plan) => {
                // A fault always triggers, because no other trigger can follow.
                let (trigger, before) = if sample.fault != 0 && self.last.fault == 0 {
                    (Trigger::Fault, self.ring.len().saturating_sub(AFTER_FAULT))
                } else if plan.is_met(&self.last, sample) {
                    (plan.kind(), self.before)
                } else {
                    return;
                };
                let before = before.min(self.filled - 1);
                let room = self.ring.len() - before - 1;
                let after = match trigger {
                    Trigger::Fault => room.min(AFTER_FAULT),
                    _ => room,
                };
                let held = Held {
                    trigger,
                    samples: before + 1 + after,
                    triggered_at: before,
                    period: period.wrapping_sub(before as u32),
                };
                self.state = State::Fills { held, left: after };
            }
            State::Fills { held, left } => {
                *left = left.saturating_sub(1);
                if *left == 0 {
                    self.state = State::Holds(*held);
                }
            }
            State::Holds(_) => {}
        }
    }

    /// Starts sending a complete capture.
    ///
    /// # Errors
    ///
    /// [`CaptureError::NotComplete`].
    pub fn send(&mut self) -> Result<Held, CaptureError> {
        match self.state {
            State::Holds(held) => {
                self.sending = Sending::Head;
                Ok(held)
            }
            _ => Err(CaptureError::NotComplete),
        }
    }

    /// The next part to send. Samples are written to `chunk`.
    pub fn next_part(&mut self, chunk: &mut [ShortSample]) -> Option<Part> {
        let State::Holds(held) = self.state else {
            return None;
        };
        let first = match self.sending {
            Sending::Nothing => return None,
            Sending::Head => {
                self.sending = Sending::Samples(0);
                return Some(Part::Head(held));
            }
            Sending::Samples(first) => first,
        };
        let count = chunk.len().min(held.samples - first);
        let oldest = self.head + self.ring.len() - held.samples;
        for (offset, place) in chunk.iter_mut().take(count).enumerate() {
            let index = (oldest + first + offset) % self.ring.len();
            *place = self.ring.get(index).copied().unwrap_or_default();
        }
        self.sending = if first + count < held.samples {
            Sending::Samples(first + count)
        } else {
            Sending::Nothing
        };
        Some(Part::Samples { first, count })
    }
}

impl TriggerPlan {
    #[inline]
    fn is_met(&self, last: &Sample, now: &Sample) -> bool {
        match *self {
            Self::Fault => false,
            Self::Now => true,
            Self::Step => {
                let jump = if now.mode == Mode::Torque as u8 {
                    JUMP_NM
                } else {
                    JUMP_RAD
                };
                let same_mode = now.mode == last.mode && now.mode > Mode::Idle as u8;
                same_mode && (now.setpoint - last.setpoint).abs() > jump
            }
            Self::Level(channel, level) => {
                let (before, now) = (last.value(channel), now.value(channel));
                (before < level) != (now < level)
            }
        }
    }
}
