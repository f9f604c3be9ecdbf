//! Drift of dry friction over time.

use crate::decay::Decay;

/// Growth of a level as something warms up: `r τ (1 − e^(−t/τ))`, or `r t` where it never settles; from a cold device to the one
/// that the level is of, `−r τ e^(−t/τ)`. A step, as of something that comes loose, adds to that from its instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Relative, at the start, 1/s.
    pub rate_per_s: f64,
    /// Time constant with which it settles, s.
    pub settling_s: Option<f64>,
    /// Whether the level is that where it settles, and not that at the start.
    pub settled: bool,
    /// Relative growth at once.
    pub step: f64,
    /// When that comes, s after the start.
    pub step_s: f64,
    /// When it starts, s of the session.
    pub start_s: f64,
    /// Whether it starts anew with a run whose clock does.
    pub anew: bool,
}

impl Drift {
    /// The instant of the session at which it steps.
    #[inline]
    fn steps_at_s(&self) -> f64 {
        self.start_s + self.step_s
    }

    /// The same if there is a step and it is to come after `t_s`; infinite if not.
    #[inline]
    pub(super) fn next_step(&self, t_s: f64) -> f64 {
        if self.step != 0.0 && t_s < self.steps_at_s() {
            self.steps_at_s()
        } else {
            f64::INFINITY
        }
    }

    /// Factor `d` of the level.
    #[inline]
    pub(super) fn factor(&self, t_s: f64) -> f64 {
        self.factor_after(t_s, self.left(t_s))
    }

    /// Share that is left of the way to where it settles.
    #[inline]
    fn left(&self, t_s: f64) -> f64 {
        let settling = |settling_s: f64| (-(t_s - self.start_s) / settling_s).exp();
        self.settling_s.map_or(1.0, settling)
    }

    /// The same where that share is known.
    #[inline]
    fn factor_after(&self, t_s: f64, left: f64) -> f64 {
        let grown_s = match self.settling_s {
            Some(settling_s) if self.settled => -settling_s * left,
            Some(settling_s) => settling_s * (1.0 - left),
            None => t_s - self.start_s,
        };
        let stepped = if t_s < self.steps_at_s() {
            0.0
        } else {
            self.step
        };
        (1.0 + self.rate_per_s * grown_s + stepped).max(0.0)
    }
}

/// A drift on its way, by steps that mostly take as long.
pub(super) struct Drifting {
    drift: Drift,
    t_s: f64,
    left: f64,
    decay: Decay,
}

impl Drifting {
    pub(super) fn from(drift: Drift, t_s: f64) -> Self {
        Self {
            drift,
            t_s,
            left: drift.left(t_s),
            decay: Decay::default(),
        }
    }

    /// Factor of the level at a time later than the last one.
    #[inline]
    pub(super) fn factor(&mut self, t_s: f64) -> f64 {
        if let Some(settling_s) = self.drift.settling_s {
            self.left *= self.decay.over(t_s - self.t_s, || -settling_s.recip());
            self.t_s = t_s;
        }
        self.drift.factor_after(t_s, self.left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Friction;

    const STEP: Drift = Drift {
        rate_per_s: 0.0,
        settling_s: None,
        settled: false,
        step: -0.5,
        step_s: 2e3,
        start_s: 0.0,
        anew: false,
    };

    #[test]
    fn a_level_that_steps_is_another_from_then_on() {
        let friction = Friction {
            drift: Some(STEP),
            ..Friction::coulomb(2.0)
        };
        assert_eq!(friction.holding(1.0, 0.0, 1999.0, 0.0), 2.0);
        assert_eq!(friction.holding(1.0, 0.0, 2001.0, 0.0), 1.0);
    }

    #[test]
    fn a_level_that_drifts_grows_on_or_settles() {
        let level = |settling_s, settled, t_s| {
            let drift = Some(Drift {
                rate_per_s: 0.1,
                settling_s,
                settled,
                start_s: 5.0,
                ..STEP
            });
            let friction = Friction {
                drift,
                ..Friction::coulomb(2.0)
            };
            friction.holding(1.0, 0.0, 5.0 + t_s, 0.0)
        };
        let left = (-1.0f64).exp();
        assert!((level(None, false, 30.0) - 8.0).abs() < 1e-12);
        assert!((level(Some(10.0), false, 10.0) - 2.0 * (2.0 - left)).abs() < 1e-12);
        assert!((level(Some(10.0), false, 1e3) - 4.0).abs() < 1e-12);
        assert!((level(Some(10.0), true, 10.0) - 2.0 * (1.0 - left)).abs() < 1e-12);
        assert!((level(Some(10.0), true, 1e3) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn on_its_way_it_is_as_far_as_at_any_time() {
        for settled in [false, true] {
            let drift = Drift {
                rate_per_s: 0.2,
                settling_s: Some(0.4),
                settled,
                step_s: 0.5,
                ..STEP
            };
            let mut drifting = Drifting::from(drift, 0.1);
            for i in 1..1000 {
                let t_s = 0.1 + 1e-3 * f64::from(i);
                assert!((drifting.factor(t_s) - drift.factor(t_s)).abs() < 1e-12);
            }
        }
    }
}
