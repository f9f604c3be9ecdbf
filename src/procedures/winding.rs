//! Duty and current of the winding in each control period of a periodic excitation, averaged over many of its periods.

use crate::telemetry::Sample;

/// Control periods per period of the excitation.
pub const PHASES: usize = 16;

/// Sums of duty and current per phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Winding {
    watching: bool,
    phase: usize,
    periods: u32,
    duty: [f32; PHASES],
    current_a: [f32; PHASES],
}

impl Winding {
    /// Starts the measurement.
    pub fn watch(&mut self) {
        *self = Self {
            watching: true,
            ..Self::default()
        };
    }

    /// Ends the measurement. Returns the mean duty and the mean current, A, of each phase. `None` if fewer than `periods`
    /// periods were measured.
    pub fn means(&mut self, periods: u32) -> Option<[[f32; PHASES]; 2]> {
        if self.periods < periods {
            return None;
        }
        self.watching = false;
        let share = 1.0 / self.periods as f32;
        Some([self.duty, self.current_a].map(|sums| sums.map(|sum| sum * share)))
    }

    /// Adds the sample of a control period.
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
