//! Hysteresis: a reading that stays behind when the motion reverses.

/// Width and shape of a hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// Largest deviation of the reading to either side, in units of position.
    pub half_width: f64,
    /// Way after a reversal over which the deviation approaches its largest value, to 1/e, in units of position. The shape
    /// is that of Dahl's friction model (A solid friction model, 1968). With 0 it is play: the reading does not move until
    /// the play is crossed.
    pub reach: f64,
}

impl Hysteresis {
    /// No hysteresis.
    pub const NONE: Self = Self {
        half_width: 0.0,
        reach: 0.0,
    };

    /// True if there is no hysteresis.
    pub fn is_none(&self) -> bool {
        self.half_width == 0.0
    }

    /// The deviation after a motion by `step`, which started with the deviation `behind`.
    #[inline]
    pub fn after(&self, behind: f64, step: f64) -> f64 {
        if self.reach == 0.0 {
            // `clamp` is not used, because it panics if the position has become NaN.
            return (behind + step).max(-self.half_width).min(self.half_width);
        }
        let last = self.half_width.copysign(step);
        last + (behind - last) * (-step.abs() / self.reach).exp()
    }

    /// Fraction of a motion in `direction` (its sign counts) that the reading shows at the deviation `behind`.
    pub fn shown(&self, behind: f64, direction: f64) -> f64 {
        let to_go = self.half_width - behind * direction.signum();
        if self.reach > 0.0 {
            1.0 - to_go / self.reach
        } else if to_go > 0.0 {
            0.0
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAY: Hysteresis = Hysteresis {
        half_width: 0.01,
        reach: 0.0,
    };
    const SOFT: Hysteresis = Hysteresis {
        reach: 0.03,
        ..PLAY
    };

    #[test]
    fn play_is_crossed_before_the_reading_moves() {
        assert!((PLAY.after(0.01, -0.015) + 0.005).abs() < 1e-15);
        assert_eq!(PLAY.after(-0.005, -0.1), -0.01);
        assert_eq!(PLAY.shown(-0.005, -1.0), 0.0);
        assert_eq!(PLAY.shown(-0.01, -1.0), 1.0);
        assert_eq!(PLAY.shown(-0.01, 1.0), 0.0);
    }

    #[test]
    fn a_soft_hysteresis_does_not_depend_on_the_step_size_and_shows_the_rest_of_the_motion() {
        let at_once = SOFT.after(0.01, -0.02);
        let in_steps = (0..20).fold(0.01, |behind, _| SOFT.after(behind, -0.001));
        assert!((at_once - in_steps).abs() < 1e-15);
        let tiny = 1e-9;
        let share = 1.0 - (SOFT.after(at_once, -tiny) - at_once) / -tiny;
        assert!((SOFT.shown(at_once, -1.0) - share).abs() < 1e-6);
        assert!((SOFT.after(at_once, -1.0) + 0.01).abs() < 1e-9);
    }
}
