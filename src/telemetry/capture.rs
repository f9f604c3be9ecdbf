//! An oscilloscope: every control period in memory, around a trigger.

use core::fmt;

use link::{Channel, Sample, ShortSample, Trigger};

use crate::controller::Mode;

/// What a capture waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TriggerPlan {
    /// A fault that is latched.
    #[default]
    Fault,
    /// A jump of the reference.
    Step,
    /// A channel that passes a value, in its unit, in either direction.
    Level(Channel, f32),
    /// Nothing.
    Now,
}

impl TriggerPlan {
    /// Its kind.
    pub fn kind(&self) -> Trigger {
        match self {
            Self::Fault => Trigger::Fault,
            Self::Step => Trigger::Step,
            Self::Level(..) => Trigger::Level,
            Self::Now => Trigger::Now,
        }
    }
}

/// What is to be captured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturePlan {
    /// When.
    pub trigger: TriggerPlan,
    /// Samples before the trigger.
    pub before: usize,
}

/// How far a capture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CaptureState {
    /// Waits for its trigger.
    Waits(TriggerPlan),
    /// Takes what follows its trigger.
    Fills(Trigger),
    /// Is complete, and kept until the next one is asked for.
    Holds(Held),
}

/// A complete capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Held {
    /// What triggered it.
    pub trigger: Trigger,
    /// How many samples it has.
    pub samples: usize,
    /// Index of the sample at which the trigger came.
    pub triggered_at: usize,
    /// Control period of the first sample.
    pub period: u32,
}

/// Why there is nothing to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureError {
    /// The capture is not complete.
    NotComplete,
    /// Fewer samples before the trigger than the memory has.
    TooLong {
        /// How many it has.
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

/// A jump of the reference: more than this from one sample to the next, rad (0.1°), or N m at the motor.
const JUMP_RAD: f32 = 1.745e-3;
const JUMP_NM: f32 = 1e-4;

/// Samples that a fault's capture takes after the fault, ten milliseconds at 20 kHz: what led to it matters more.
const AFTER_FAULT: usize = 200;

/// A ring of samples, and when to stop filling it. It always waits for something; by itself, for a fault.
#[derive(Debug)]
pub struct Capture {
    ring: &'static mut [ShortSample],
    /// Where the next sample goes, and how many there are.
    head: usize,
    filled: usize,
    before: usize,
    state: State,
    last: Sample,
    /// What is to be sent next of a complete capture.
    sending: Sending,
}

/// A part of a complete capture, as it is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What it is.
    Head(Held),
    /// Some samples.
    Samples {
        /// Index of the first one.
        first: usize,
        /// How many.
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
    /// Waits for a fault.
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

    /// Most samples of a capture.
    pub fn capacity(&self) -> usize {
        self.ring.len()
    }

    /// The plan by which a fault is captured.
    pub fn for_faults(&self) -> CapturePlan {
        CapturePlan {
            trigger: TriggerPlan::Fault,
            before: self.ring.len().saturating_sub(AFTER_FAULT),
        }
    }

    /// Begins a capture; what was held is forgotten. A trigger counts from now on, though less may be there before it than
    /// was asked for.
    ///
    /// # Errors
    /// [`CaptureError::TooLong`] for more samples before the trigger than there is room for.
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

    /// How far it is.
    pub fn state(&self) -> CaptureState {
        match self.state {
            State::Waits(trigger) => CaptureState::Waits(trigger),
            State::Fills { held, .. } => CaptureState::Fills(held.trigger),
            State::Holds(held) => CaptureState::Holds(held),
        }
    }

    /// Takes the sample of control period `period`.
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
        // The first one has none before it to be compared with.
        if self.filled > 1 {
            self.decide(period, sample);
        }
        self.last = *sample;
    }

    #[inline]
    fn decide(&mut self, period: u32, sample: &Sample) {
        match &mut self.state {
            State::Waits(plan) => {
                // A fault ends whatever was waited for: nothing else will come.
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

    /// Begins to send a complete capture.
    ///
    /// # Errors
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

    /// The next part to be sent; samples are written to `chunk`.
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
