//! Drift of dry friction over time.

use crate::decay::Decay;

/// Relative growth of a friction level, as of a device that warms up: `r τ (1 − e^(−t/τ))`, or `r t` if it never
/// settles. If the level is that of the warm device, the growth is `−r τ e^(−t/τ)`. A step, as of a part that comes
/// loose, adds to the growth from its instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Relative growth per second at the start, 1/s.
    pub rate_per_s: f64,
    /// Time constant with which it settles, s; `None` if it never does.
    pub settling_s: Option<f64>,
    /// True if the level is that of the settled device, false if it is that at the start.
    pub settled: bool,
    /// Relative height of a step.
    pub step: f64,
    /// When the step comes, s after the start.
    pub step_s: f64,
    /// When the drift starts, s of the session.
    pub start_s: f64,
    /// True if the drift restarts with each run whose clock restarts.
    pub anew: bool,
}

impl Drift {
    /// The instant of the step, s of the session.
    #[inline]
    fn steps_at_s(&self) -> f64 {
        self.start_s + self.step_s
    }

    /// The instant of the step if it comes after `t_s`, s of the session; otherwise infinite.
    #[inline]
    pub(super) fn next_step(&self, t_s: f64) -> f64 {
        if self.step != 0.0 && t_s < self.steps_at_s() {
            self.steps_at_s()
        } else {
            f64::INFINITY
        }
    }

    /// Factor of the level at `t_s` of the session.
    #[inline]
    pub(super) fn factor(&self, t_s: f64) -> f64 {
        self.factor_after(t_s, self.left(t_s))
    }

    /// Share of the drift that is still to come at `t_s` of the session.
    #[inline]
    fn left(&self, t_s: f64) -> f64 {
        let settling = |settling_s: f64| (-(t_s - self.start_s) / settling_s).exp();
        self.settling_s.map_or(1.0, settling)
    }

    /// Factor of the level at `t_s` of the session, where the share that is still to come is known.
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

/// A drift that is evaluated at one instant after the other, mostly at equal distances.
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

    /// Factor of the level at `t_s` of the session, which is later than the last one.
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
    fn a_step_changes_the_level_from_its_instant_on() {
        let friction = Friction {
            drift: Some(STEP),
            ..Friction::coulomb(2.0)
        };
        assert_eq!(friction.holding(1.0, 0.0, 1999.0, 0.0), 2.0);
        assert_eq!(friction.holding(1.0, 0.0, 2001.0, 0.0), 1.0);
    }

    #[test]
    fn a_drifting_level_grows_or_settles() {
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
    fn successive_evaluations_equal_direct_ones() {
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
