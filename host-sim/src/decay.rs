//! Exponential decay over times that are often repeated.

/// Computes exp(rate · time) and caches the results of two times. A time close to a cached one needs no exponential
/// function.
#[derive(Clone, Copy, Debug)]
pub struct Decay {
    rate_per_s: f64,
    known: [Known; 2],
}

#[derive(Clone, Copy, Debug)]
struct Known {
    time_s: f64,
    left: f64,
}

/// Largest exponent of the series. Its error is then below 1e-13.
const SMALL: f64 = 0.02;
/// Coefficients of the series, highest order first.
const SERIES: [f64; 6] = [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];

impl Default for Decay {
    fn default() -> Self {
        let none = Known {
            time_s: f64::INFINITY,
            left: 0.0,
        };
        Self {
            rate_per_s: 0.0,
            known: [none; 2],
        }
    }
}

impl Decay {
    /// exp(`rate_per_s` · `time_s`). The negative `rate_per_s` must be the same in all calls.
    #[inline]
    pub fn over(&mut self, time_s: f64, rate_per_s: impl FnOnce() -> f64) -> f64 {
        for known in &self.known {
            let more = self.rate_per_s * (time_s - known.time_s);
            if more.abs() <= SMALL {
                let series = SERIES.iter();
                return known.left * series.fold(0.0, |sum, factor| factor + more * sum);
            }
        }
        self.anew(time_s, rate_per_s())
    }

    #[cold]
    fn anew(&mut self, time_s: f64, rate_per_s: f64) -> f64 {
        let left = (time_s * rate_per_s).exp();
        // An infinite rate is not cached, because the series would not be defined.
        if rate_per_s.is_finite() {
            self.rate_per_s = rate_per_s;
            self.known = [Known { time_s, left }, self.known[0]];
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_for_nearly_repeated_times_is_accurate() {
        let mut decay = Decay::default();
        for i in 0..1000 {
            let time_s = 1e-3 * (1.0 + 0.03 * f64::from(i % 7)) * f64::from(1 + i % 3);
            let left = decay.over(time_s, || -200.0);
            assert!((left - (-200.0 * time_s).exp()).abs() < 1e-13);
        }
        assert_eq!(Decay::default().over(1e-3, || f64::NEG_INFINITY), 0.0);
    }
}
