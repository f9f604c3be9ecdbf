//! A reading that stays behind where the motion turns.

/// How far a reading stays behind, and over which way it comes to that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// Farthest that it is behind to either side, in units of position.
    pub half_width: f64,
    /// Way after a turn over which it comes to that, to 1/e, as a friction does after Dahl (A solid friction model, 1968), in
    /// units of position; 0 for play, in which the reading does not move at all.
    pub reach: f64,
}

impl Hysteresis {
    /// Never behind.
    pub const NONE: Self = Self {
        half_width: 0.0,
        reach: 0.0,
    };

    /// True if it is never behind.
    pub fn is_none(&self) -> bool {
        self.half_width == 0.0
    }

    /// How far it is behind after a `step` one way, having been so far `behind`.
    #[inline]
    pub fn after(&self, behind: f64, step: f64) -> f64 {
        if self.reach == 0.0 {
            // Not `clamp`: a position that has run away may be no number.
            return (behind + step).max(-self.half_width).min(self.half_width);
        }
        let last = self.half_width.copysign(step);
        last + (behind - last) * (-step.abs() / self.reach).exp()
    }

    /// Share of a motion in the `direction` of a number that shows where it is so far `behind`.
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
    fn softly_it_comes_to_stay_behind_whatever_the_steps_and_shows_what_is_left() {
        let at_once = SOFT.after(0.01, -0.02);
        let in_steps = (0..20).fold(0.01, |behind, _| SOFT.after(behind, -0.001));
        assert!((at_once - in_steps).abs() < 1e-15);
        let tiny = 1e-9;
        let share = 1.0 - (SOFT.after(at_once, -tiny) - at_once) / -tiny;
        assert!((SOFT.shown(at_once, -1.0) - share).abs() < 1e-6);
        assert!((SOFT.after(at_once, -1.0) + 0.01).abs() < 1e-9);
    }
}
