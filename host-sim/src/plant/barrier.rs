//! A spring with a damper that acts on the joint: a hard stop, or something outside that resists, holds or pushes it.

/// Pushes back once the joint is past `at`. It never pulls, and it damps only while in contact. With `side` 0 it holds
/// the joint at `at`: it pulls as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// Position at which contact begins, rad.
    pub at: f64,
    /// +1 if it stops positive motion, -1 if negative, 0 if both.
    pub side: f64,
    /// Stiffness, N m/rad.
    pub stiffness: f64,
    /// Damping in contact, N m s/rad.
    pub damping: f64,
    /// Constant torque in addition, at any position of the joint, N m.
    pub torque_nm: f64,
    /// Interval of the session in which it acts, s; `None` = always.
    pub during_s: Option<[f64; 2]>,
}

/// The contact between joint and barrier. The torque is smooth as long as it stays the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// Not reached.
    Free,
    /// In contact and pushing, or held.
    Pushing,
    /// Past the edge, but receding faster than the spring follows.
    Released,
}

impl Barrier {
    /// True if it acts at `time_s` of the session.
    #[inline]
    pub fn is_there(&self, time_s: f64) -> bool {
        self.during_s
            .is_none_or(|[from, to]| time_s >= from && time_s < to)
    }

    /// The next instant after `time_s` at which it begins or ceases to act, s of the session.
    #[inline]
    pub(super) fn next_change(&self, time_s: f64) -> f64 {
        match self.during_s {
            Some([from, _]) if time_s < from => from,
            Some([_, to]) if time_s < to => to,
            _ => f64::INFINITY,
        }
    }

    #[inline]
    fn holds(&self) -> bool {
        self.side == 0.0
    }

    #[inline]
    fn depth(&self, position: f64) -> f64 {
        self.side * (position - self.at)
    }

    #[inline]
    fn push(&self, position: f64, velocity: f64) -> f64 {
        self.stiffness * self.depth(position) + self.damping * self.side * velocity
    }

    /// Natural frequency plus damping of an inertia on the barrier, 1/s.
    #[inline]
    pub(super) fn rate(&self, inverse_inertia: f64) -> f64 {
        (self.stiffness.abs() * inverse_inertia).sqrt() + self.damping * inverse_inertia
    }

    /// The contact at this position and velocity.
    pub fn touch(&self, position: f64, velocity: f64) -> Touch {
        if self.holds() {
            return Touch::Pushing;
        }
        let (depth, push) = (self.depth(position), self.push(position, velocity));
        if depth < 0.0 || (depth == 0.0 && self.side * velocity <= 0.0) {
            Touch::Free
        } else if push > 0.0 {
            Touch::Pushing
        } else {
            Touch::Released
        }
    }

    /// Torque on the joint, N m.
    #[inline]
    pub fn torque(&self, touch: Touch, position: f64, velocity: f64) -> f64 {
        match touch {
            Touch::Pushing => {
                self.torque_nm - self.stiffness * (position - self.at) - self.damping * velocity
            }
            Touch::Free | Touch::Released => 0.0,
        }
    }

    /// Positive while `touch` lasts.
    #[inline]
    pub fn guard(&self, touch: Touch, position: f64, velocity: f64) -> f64 {
        // A torque over the stiffness is a position, so that both guards have one unit.
        let depth = self.depth(position);
        let push = || self.push(position, velocity) / self.stiffness.max(f64::MIN_POSITIVE);
        match touch {
            Touch::Free => -depth,
            Touch::Pushing if self.holds() => f64::INFINITY,
            Touch::Pushing => depth.min(push()),
            Touch::Released => depth.min(-push()),
        }
    }
}
