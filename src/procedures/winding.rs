//! What the winding does in each control period of a periodic excitation: the means over many of its periods, in which noise
//! averages out.

use crate::telemetry::Sample;

/// Control periods in a period of the excitation.
pub const PHASES: usize = 16;

/// The sums.
#[derive(Clone, Copy, Debug, Default)]
pub struct Winding {
    watching: bool,
    phase: usize,
    periods: u32,
    duty: [f32; PHASES],
    current_a: [f32; PHASES],
}

impl Winding {
    /// Begins anew.
    pub fn watch(&mut self) {
        *self = Self {
            watching: true,
            ..Self::default()
        };
    }

    /// Ends, with the mean duty and current, A, of each control period; `None` if there are not so many periods yet.
    pub fn means(&mut self, periods: u32) -> Option<[[f32; PHASES]; 2]> {
        if self.periods < periods {
            return None;
        }
        self.watching = false;
        let share = 1.0 / self.periods as f32;
        Some([self.duty, self.current_a].map(|sums| sums.map(|sum| sum * share)))
    }

    /// Takes a control period's sample.
    #[inline]
    pub fn add(&mut self, sample: &Sample) {
        if !self.watching {
            return;
        }
        if let (Some(duty), Some(current_a)) = (
            self.duty.get_mut(self.phase),
            self.current_a.get_mut(self.phase),
        ) {
            *duty += sample.duty;
            *current_a += sample.current_a;
        }
        self.phase += 1;
        if self.phase == PHASES {
            self.phase = 0;
            self.periods += 1;
        }
    }
}
