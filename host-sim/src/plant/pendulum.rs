//! Gravity on the joint.

/// Reach of the expansion, rad: its error is below 3e-9 up to this angle from its centre.
const REACH_RAD: f64 = 0.05;

/// Sine and cosine of an angle, expanded about a centre that follows the motion. A step then needs no call of a sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pendulum {
    centre: f64,
    sin: f64,
    cos: f64,
}

impl Pendulum {
    /// The expansion about `angle`, rad.
    #[inline]
    pub(super) fn about(angle: f64) -> Self {
        Self {
            centre: angle,
            sin: angle.sin(),
            cos: angle.cos(),
        }
    }

    /// Moves the centre to `angle`, rad, if the two are too far apart.
    #[inline]
    pub(super) fn follow(&mut self, angle: f64) {
        // The other half of the reach is left for the next step.
        if (angle - self.centre).abs() > 0.5 * REACH_RAD {
            *self = Self::about(angle);
        }
    }

    /// Sine of `angle`, rad, by the expansion to the fourth power.
    #[inline]
    pub(super) fn sin(&self, angle: f64) -> f64 {
        let d = angle - self.centre;
        if d.abs() > REACH_RAD {
            return angle.sin();
        }
        let (sin, cos) = (self.sin, self.cos);
        (sin + d * cos) + d * d * ((d * d) * (sin / 24.0) - (0.5 * sin + d * (cos / 6.0)))
    }
}
