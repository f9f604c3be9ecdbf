//! Conversion between core cycles and seconds.

/// A clock whose rate can change.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    since_cycle: u64,
    since_s: f64,
    hz: f64,
}

impl Clock {
    /// A clock that starts at cycle `cycle` and time `s` with the rate `hz`.
    pub fn new(cycle: u64, s: f64, hz: f64) -> Self {
        Self {
            since_cycle: cycle,
            since_s: s,
            hz,
        }
    }

    /// Changes the rate at cycle `now`.
    pub fn set_rate(&mut self, now: u64, hz: f64) {
        *self = Self::new(now, self.seconds(now), hz);
    }

    /// Core cycles per second.
    pub fn hz(&self) -> f64 {
        self.hz
    }

    /// Time at `cycle`, s.
    #[inline]
    pub fn seconds(&self, cycle: u64) -> f64 {
        self.since_s + cycle.saturating_sub(self.since_cycle) as f64 / self.hz
    }

    /// The first cycle at or after time `s`.
    #[inline]
    pub fn cycle_at(&self, s: f64) -> u64 {
        self.since_cycle + ((s - self.since_s) * self.hz).ceil().max(0.0) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_rate_keeps_the_time_before_it() {
        let mut clock = Clock::new(0, 0.0, 16e6);
        clock.set_rate(16_000, 168e6);
        assert!((clock.seconds(16_000 + 168_000) - 2e-3).abs() < 1e-12);
        assert_eq!(clock.cycle_at(2e-3), 16_000 + 168_000);
    }
}
