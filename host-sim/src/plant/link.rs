//! A transmission that is not rigid.

/// Splits the inertia in two, with a spring, a damper and play between the halves. The drive, cogging
/// and the constant torque act on the motor side; gravity, springs and barriers on the load side; friction,
/// viscous and dry, in the bearings of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Share of the inertia on the load side, between 0 and 1.
    pub load_share: f64,
    /// Stiffness of the spring, N m/rad.
    pub stiffness: f64,
    /// Damping of the spring, N m s/rad.
    pub damping: f64,
    /// Free travel between the two contacts, rad.
    pub play: f64,
    /// Share of the friction on the load side, between 0 and 1; none of it where friction has bristles.
    pub load_friction: f64,
    /// True if the position sensor sits on the load side.
    pub sensor_on_load: bool,
}

/// The contact between the two sides of a link. Its torque is linear as long as the contact stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flank {
    /// No contact.
    Apart,
    /// Contact on one flank, on the side of this sign of the twist. The sides push each other and never pull.
    Pushing(f64),
    /// No play: the sides push and pull each other.
    Bound,
}

impl Link {
    /// No link.
    pub(super) const NONE: Self = Self {
        load_share: 0.0,
        stiffness: 0.0,
        damping: 0.0,
        play: 0.0,
        load_friction: 0.0,
        sensor_on_load: false,
    };

    /// The twist beyond the play, and the twist at which the spring alone would have the present torque, rad.
    #[inline]
    fn depth_and_push(&self, side: f64, twist: f64, rate: f64) -> (f64, f64) {
        // A torque over the stiffness is a position, so that both have one unit.
        let follows_s = self.damping / self.stiffness.max(f64::MIN_POSITIVE);
        let depth = side * twist - 0.5 * self.play;
        (depth, depth + follows_s * side * rate)
    }

    /// The flank at a relative position and velocity.
    #[inline]
    pub(super) fn flank(&self, twist: f64, rate: f64) -> Flank {
        if self.play == 0.0 {
            return Flank::Bound;
        }
        let side = 1f64.copysign(twist);
        let (depth, push) = self.depth_and_push(side, twist, rate);
        if depth >= 0.0 && push > 0.0 {
            Flank::Pushing(side)
        } else {
            Flank::Apart
        }
    }

    /// Positive while `flank` lasts, rad.
    #[inline]
    pub(super) fn guard(&self, flank: Flank, twist: f64, rate: f64) -> f64 {
        match flank {
            Flank::Bound => f64::INFINITY,
            Flank::Pushing(side) => {
                let (depth, push) = self.depth_and_push(side, twist, rate);
                depth.min(push)
            }
            Flank::Apart => {
                let (depth, push) = self.depth_and_push(1f64.copysign(twist), twist, rate);
                (-depth).max(-push)
            }
        }
    }

    /// Stiffness, damping and relaxed twist within a flank, N m/rad, N m s/rad and rad.
    #[inline]
    pub(super) fn spring(&self, flank: Flank) -> (f64, f64, f64) {
        match flank {
            Flank::Apart => (0.0, 0.0, 0.0),
            Flank::Pushing(side) => (self.stiffness, self.damping, 0.5 * self.play * side),
            Flank::Bound => (self.stiffness, self.damping, 0.0),
        }
    }

    /// Torque from the motor side on the load side at a relative position and velocity, N m.
    #[inline]
    pub(super) fn torque(&self, twist: f64, rate: f64) -> f64 {
        let (stiffness, damping, relaxed) = self.spring(self.flank(twist, rate));
        stiffness * (twist - relaxed) + damping * rate
    }

    /// Fastest rate of the relative motion without its damping, 1/s.
    pub(super) fn natural_rate(&self, inertia: f64) -> f64 {
        (self.stiffness / self.reduced(inertia)).sqrt()
    }

    fn reduced(&self, inertia: f64) -> f64 {
        inertia * self.load_share * (1.0 - self.load_share)
    }

    /// The link with its stiffness and damping limited to those of a link that rings at `rate`, rad/s, and is
    /// critically damped.
    pub fn bounded(self, inertia: f64, rate: f64) -> Self {
        let reduced = self.reduced(inertia);
        Self {
            stiffness: self.stiffness.min(rate * rate * reduced),
            damping: self.damping.min(2.0 * rate * reduced),
            ..self
        }
    }

    /// Time constant with which an oscillation of the two sides decays, s; infinite without damping.
    pub fn memory_s(&self, inertia: f64) -> f64 {
        2.0 * self.reduced(inertia) / self.damping
    }

    /// Fastest rate of the relative motion, 1/s.
    pub(super) fn fastest_rate(&self, inertia: f64) -> f64 {
        self.natural_rate(inertia) + self.damping / self.reduced(inertia)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounded_link_has_at_most_the_given_natural_rate() {
        let soft = Link {
            load_share: 0.5,
            stiffness: 4.0,
            damping: 0.1,
            play: 0.01,
            load_friction: 0.5,
            sensor_on_load: false,
        };
        assert_eq!(soft.bounded(0.04, 100.0), soft);
        let hard = Link {
            stiffness: 4e6,
            damping: 1e3,
            ..soft
        };
        let bounded = hard.bounded(0.04, 100.0);
        let natural = (bounded.stiffness / bounded.reduced(0.04)).sqrt();
        assert!((natural - 100.0).abs() < 1e-9);
        // Critically damped: twice the natural frequency over the reduced inertia.
        assert!((bounded.damping / bounded.reduced(0.04) - 200.0).abs() < 1e-9);
    }
}
