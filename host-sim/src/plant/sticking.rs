//! Dry friction at rest: the level that holds a joint, and the drive that breaks it away.

use super::event::locate;
use super::{Phase, Plant, Rest, State, Torque};

impl Plant {
    /// The phase of the motor side after a rest under this drive torque, N m.
    #[inline]
    pub(super) fn phase_at_rest(&self, state: &State, drive_nm: f64) -> Phase {
        let pull = self.pull(state, drive_nm, self.through(state));
        if pull.abs() <= self.holding(state, pull, drive_nm) {
            Phase::Stick
        } else {
            Phase::sliding(pull)
        }
    }

    /// The phase of the load side after a rest under this drive torque, N m.
    #[inline]
    pub(super) fn load_phase_at_rest(&self, state: &State, drive_nm: f64) -> Phase {
        let pull = self.load_pull(state, self.through(state));
        if pull.abs() <= self.load_holding(state, pull, drive_nm) {
            Phase::Stick
        } else {
            Phase::sliding(pull)
        }
    }

    /// Level that holds the load side against `pull` at rest, N m.
    #[inline]
    pub(super) fn load_holding(&self, state: &State, pull: f64, drive_nm: f64) -> f64 {
        let direction = if pull >= 0.0 { 1.0 } else { -1.0 };
        let (position, time_s) = (state.load_position, state.time_s);
        self.friction_share[1]
            * self
                .mechanics
                .holding(direction, position, time_s, drive_nm)
    }

    /// True if the load side has dry friction of its own.
    #[inline]
    pub(super) fn load_is_dry(&self) -> bool {
        self.dry && self.friction_share[1] > 0.0
    }

    /// Level that holds the motor side against `pull` at rest, N m.
    #[inline]
    pub(super) fn holding(&self, state: &State, pull: f64, drive_nm: f64) -> f64 {
        self.holding_at(state.position, state.time_s, pull, drive_nm)
    }

    #[inline]
    fn holding_at(&self, position: f64, time_s: f64, pull: f64, drive_nm: f64) -> f64 {
        let m = &self.mechanics;
        self.friction_share[0]
            * if self.plain {
                m.friction.level(pull)
            } else {
                let direction = if pull >= 0.0 { 1.0 } else { -1.0 };
                m.holding(direction, position, time_s, drive_nm)
            }
    }

    /// Dry friction on the motor side (0) or the load side (1) while sliding, if it depends on the direction alone, N m.
    #[inline]
    pub(super) fn constant_friction_nm(&self, side: usize, direction: f64) -> Option<f64> {
        (self.plain || direction == 0.0).then(|| self.level_nm(side, direction))
    }

    /// Dry friction on the motor side (0) or the load side (1) while sliding, before any dependence on anything but the
    /// direction, N m.
    #[inline]
    pub(super) fn level_nm(&self, side: usize, direction: f64) -> f64 {
        self.friction_share[side] * direction * self.mechanics.friction.level(direction)
    }

    /// True if the joint is at rest and the torque on it, without the drive, stays the same while it rests.
    #[inline]
    pub(super) fn rests(&self, state: &State) -> bool {
        self.rest_is_steady && state.phase == Phase::Stick && state.velocity == 0.0
    }

    /// True if the joint is at rest and no drive between two bounds, N m, breaks it away within the next `within_s`.
    /// Friction is taken at their end, where it has drifted farthest.
    #[inline]
    pub(super) fn stays_at_rest(
        &self,
        state: &mut State,
        bounds_nm: [f64; 2],
        within_s: f64,
    ) -> bool {
        if !self.rests(state) {
            return false;
        }
        if self.holds_steadily {
            let [lowest_nm, highest_nm] = self.rest_at(state).holds_nm;
            return lowest_nm <= bounds_nm[0] && bounds_nm[1] <= highest_nm;
        }
        let (position, end_s) = (state.position, state.time_s + within_s);
        let holding = |pull: f64, drive_nm: f64| self.holding_at(position, end_s, pull, drive_nm);
        self.is_held_by(state, bounds_nm, holding)
    }

    /// True if friction holds the resting joint under any drive between two bounds, N m. `holding` is its level by
    /// torque and drive, N m.
    #[inline]
    pub(super) fn is_held_by(
        &self,
        state: &mut State,
        [low, high]: [f64; 2],
        holding: impl Fn(f64, f64) -> f64,
    ) -> bool {
        let still_nm = self.rest_at(state).pull_nm;
        let holds = |drive_nm: f64| {
            let pull = still_nm + drive_nm;
            pull.abs() <= holding(pull, drive_nm)
        };
        holds(low) && (low == high || holds(high))
    }

    /// The resting joint at its position.
    #[inline]
    fn rest_at<'a>(&self, state: &'a mut State) -> &'a Rest {
        if state.rest.position != state.position {
            let pull_nm = self.pull(state, 0.0, self.through(state));
            let level_nm = |direction| self.holding(state, direction, 0.0);
            state.rest = Rest {
                position: state.position,
                pull_nm,
                holds_nm: [-level_nm(-1.0) - pull_nm, level_nm(1.0) - pull_nm],
            };
        }
        &state.rest
    }

    /// Time for which the joint stays at rest, s: `left`, or until the drive breaks it away.
    pub(super) fn hold(&self, state: &State, torque: &Torque, left: f64) -> f64 {
        let still_nm = self.pull(state, 0.0, self.through(state));
        let left_to_break_nm = |t: f64| {
            let drive_nm = torque.at(t);
            let pull = still_nm + drive_nm;
            self.holding_at(state.position, state.time_s + t, pull, drive_nm) - pull.abs()
        };
        let at_end = left_to_break_nm(left);
        if at_end >= 0.0 {
            return left;
        }
        // The drive is monotonic within a step, so that it breaks the joint away once at most.
        let (breaks, ()) = locate(
            |t| (left_to_break_nm(t), ()),
            left_to_break_nm(0.0),
            (left, (at_end, ())),
            self.pace.event_tolerance,
        );
        breaks
    }
}
