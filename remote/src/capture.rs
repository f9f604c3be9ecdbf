//! A capture that the board has sent.

use link::{Body, Sample, ShortSample, Trigger};

/// The samples of successive control periods.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Captured {
    head: Option<Head>,
    /// One sample per control period.
    pub samples: Vec<Sample>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Head {
    trigger: Trigger,
    samples: usize,
    triggered_at: usize,
}

impl Captured {
    /// A complete capture, triggered at the sample with this index.
    pub fn of(trigger: Trigger, triggered_at: usize, samples: Vec<Sample>) -> Self {
        let head = Head {
            trigger,
            samples: samples.len(),
            triggered_at,
        };
        Self {
            head: Some(head),
            samples,
        }
    }

    pub(crate) fn hear(&mut self, body: &Body) {
        match *body {
            Body::Capture {
                trigger,
                samples,
                triggered_at,
                ..
            } => {
                self.samples.clear();
                self.head = Some(Head {
                    trigger,
                    samples: samples.into(),
                    triggered_at: triggered_at.into(),
                });
            }
            // Samples after lost ones are ignored.
            Body::Samples { first, samples } if usize::from(first) == self.samples.len() => {
                let (samples, _) = samples.as_chunks();
                let samples = samples.iter().copied().map(ShortSample::from_bytes);
                self.samples.extend(samples.map(Sample::from));
            }
            Body::Samples { .. } | Body::Row { .. } => {}
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.samples.len()
    }

    pub(crate) fn is_complete(&self) -> bool {
        self.head
            .is_some_and(|head| head.samples == self.samples.len())
    }

    /// The trigger that occurred.
    pub fn trigger(&self) -> Option<Trigger> {
        self.head.map(|head| head.trigger)
    }

    /// Index of the sample at the trigger.
    pub fn triggered_at(&self) -> usize {
        self.head.map_or(0, |head| head.triggered_at)
    }
}
