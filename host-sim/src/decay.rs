//! Exponential decay over times that recur.

/// What is left after a time of what decays at a rate, remembered: about the same time takes no exponential.
#[derive(Clone, Copy, Debug)]
pub struct Decay {
    time_s: f64,
    rate_per_s: f64,
    left: f64,
}

/// Exponent up to which its expansion to third order errs by less than 1e-13.
const SMALL: f64 = 1e-3;

impl Default for Decay {
    fn default() -> Self {
        Self {
            time_s: f64::INFINITY,
            rate_per_s: 0.0,
            left: 0.0,
        }
    }
}

impl Decay {
    /// Share that is left after `time_s`, where `rate_per_s`, which is negative, is always the same.
    #[inline]
    pub fn over(&mut self, time_s: f64, rate_per_s: impl FnOnce() -> f64) -> f64 {
        let more = self.rate_per_s * (time_s - self.time_s);
        if more.abs() <= SMALL {
            return self.left * (1.0 + more * (1.0 + more * (0.5 + more / 6.0)));
        }
        self.anew(time_s, rate_per_s())
    }

    #[cold]
    fn anew(&mut self, time_s: f64, rate_per_s: f64) -> f64 {
        let left = (time_s * rate_per_s).exp();
        // What decays at once leaves nothing to expand from.
        if rate_per_s.is_finite() {
            *self = Self {
                time_s,
                rate_per_s,
                left,
            };
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_nearly_recur_decay_as_all_do() {
        let mut decay = Decay::default();
        for i in 0..1000 {
            let time_s = 1e-3 * (1.0 + 1e-3 * f64::from(i % 7)) * f64::from(1 + i % 3);
            let left = decay.over(time_s, || -200.0);
            assert!((left - (-200.0 * time_s).exp()).abs() < 1e-13);
        }
        assert_eq!(Decay::default().over(1e-3, || f64::NEG_INFINITY), 0.0);
    }
}
