//! The drive: from the commanded input to the torque at the joint.

use crate::plant::{Plant, State, Torque};
use std::collections::VecDeque;

/// Saturation of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation {
    /// Largest magnitude of the input that acts, in units of input.
    pub limit: f64,
    /// Width of the rounded transition to the limit on either side, as a share of the limit from 0 to 1. The transition is a
    /// parabola.
    pub knee: f64,
    /// Velocity in the direction of the input at which the limit falls to zero, because the back-EMF equals the supply
    /// voltage. The limit falls linearly with the velocity. Infinite if the limit is constant.
    pub no_load_velocity: f64,
}

impl Saturation {
    /// No saturation.
    pub const NONE: Self = Self {
        limit: f64::INFINITY,
        knee: 0.0,
        no_load_velocity: f64::INFINITY,
    };

    /// The saturation at a velocity in the direction of the input.
    #[inline]
    fn moving(self, velocity: f64) -> Self {
        if self.no_load_velocity.is_infinite() {
            return self;
        }
        let left = (1.0 - velocity / self.no_load_velocity).max(0.0);
        Self {
            limit: left * self.limit,
            ..self
        }
    }

    /// Largest magnitude that is passed unchanged.
    #[inline]
    fn proportional(self) -> f64 {
        (1.0 - self.knee) * self.limit
    }

    /// Acting magnitude for an input magnitude.
    #[inline]
    fn of(self, magnitude: f64) -> f64 {
        let bent = magnitude - self.proportional();
        let reach = 2.0 * self.knee * self.limit;
        // An infinite limit has no transition, and its width would be undefined.
        if bent <= 0.0 || self.limit.is_infinite() {
            magnitude
        } else if bent >= reach {
            self.limit
        } else {
            magnitude - bent * bent / (2.0 * reach)
        }
    }
}

/// Static nonlinearity of the input: a dead zone followed by a power law, with another slope beyond a knee.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputCurve {
    /// Effective over actual input at the reference input.
    pub gain: f64,
    /// Exponent of the input beyond the dead zone.
    pub power: f64,
    /// Magnitude of the input up to which the effective input is zero, in units of input.
    pub dead_zone: f64,
    /// Magnitude of the reference input, in units of input.
    pub reference: f64,
    /// Magnitude of the input at which the slope changes, in units of input.
    pub knee: f64,
    /// Slope beyond the knee over that of the straight line to it. 1 for no knee.
    pub slope_beyond: f64,
}

impl InputCurve {
    /// Effective input for an input.
    #[inline]
    fn of(self, input: f64) -> f64 {
        let span = (self.reference - self.dead_zone).max(1e-3 * self.reference);
        let part = |magnitude: f64| ((magnitude - self.dead_zone) / span).max(0.0);
        let knee = part(self.knee);
        let bent = |part: f64| (self.slope_beyond - 1.0) * (part - knee).max(0.0);
        let part = part(input.abs());
        let share = (part.powf(self.power) + bent(part)) / (1.0 + bent(1.0));
        (self.gain * self.reference * share).copysign(input)
    }
}

/// A drive: limit, saturation, dead band, static nonlinearity, rate limit, delay, first-order lags and gain, in this order.
/// Optionally the dead band comes before the limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Joint torque per unit of input.
    pub ratio: f64,
    /// Largest magnitude of the input, in units of input. Infinite for no limit.
    pub limit: f64,
    /// Saturation that follows the limit.
    pub saturation: Saturation,
    /// Half width of the dead band, in units of input. Inputs within it give no torque.
    pub deadband: f64,
    /// Jump of the input at the edge of the dead band, as a share of its half width. With 0, the torque starts at zero. With
    /// 1, the full input acts beyond the edge.
    pub deadband_jump: f64,
    /// Offset of the middle of the dead band, as a share of its half width, from −1 to 1.
    pub deadband_skew: f64,
    /// True if the dead band comes before limit and saturation.
    pub deadband_first: bool,
    /// Static nonlinearity after the dead band. `None` if the torque is proportional to the input.
    pub curve: Option<InputCurve>,
    /// Largest rate of the effective input, in units of input per second. Infinite for no limit.
    pub rate_limit: f64,
    /// Dead time, s.
    pub delay_s: f64,
    /// Time constant of the lag, s.
    pub lag_s: f64,
    /// Time constant of a second lag in series, s.
    pub further_lag_s: f64,
}

impl Drive {
    /// A drive that is a pure gain, in N m per unit of input.
    pub fn ideal(ratio: f64) -> Self {
        Self {
            ratio,
            limit: f64::INFINITY,
            saturation: Saturation::NONE,
            deadband: 0.0,
            deadband_jump: 0.0,
            deadband_skew: 0.0,
            deadband_first: false,
            curve: None,
            rate_limit: f64::INFINITY,
            delay_s: 0.0,
            lag_s: 0.0,
            further_lag_s: 0.0,
        }
    }

    /// True if the torque is proportional to inputs up to the magnitude `largest`.
    #[inline]
    pub fn is_linear(&self, largest: f64) -> bool {
        let acts = if self.saturation.no_load_velocity.is_infinite() {
            self.limit.min(self.saturation.proportional())
        } else {
            0.0
        };
        self.deadband == 0.0 && self.curve.is_none() && largest <= acts
    }

    /// Time after which a past input contributes less than 1e-8, s. Infinite with a rate limit.
    pub fn memory_s(&self) -> f64 {
        const LAGS: f64 = 20.0;
        if self.rate_limit.is_finite() {
            return f64::INFINITY;
        }
        self.delay_s + LAGS * (self.lag_s + self.further_lag_s)
    }

    /// Largest rate of the torque, N m/s. Infinite for no limit.
    #[inline]
    pub fn rate_limit_nm_s(&self) -> f64 {
        self.rate_limit * self.ratio.abs()
    }

    /// Magnitude of the input at rest after limit and saturation, in units of input.
    #[inline]
    pub fn taken(&self, input: f64) -> f64 {
        self.taken_at(input, 0.0)
    }

    /// Magnitude of the input at a velocity after limit and saturation, in units of input.
    #[inline]
    fn taken_at(&self, input: f64, velocity: f64) -> f64 {
        let pushed = (self.ratio * input).signum();
        let saturation = self.saturation.moving(velocity * pushed);
        saturation.of(input.abs().min(self.limit))
    }

    /// Steady-state torque at the joint for an input at rest, N m.
    #[inline]
    pub fn settled(&self, input: f64) -> f64 {
        self.settled_at(input, 0.0)
    }

    /// Steady-state torque at the joint for an input at a velocity, N m.
    #[inline]
    pub fn settled_at(&self, input: f64, velocity: f64) -> f64 {
        if self.is_linear(input.abs()) {
            return self.ratio * input;
        }
        let taken = |input: f64| self.taken_at(input, velocity).copysign(input);
        let left = if self.deadband_first {
            taken(self.beyond_deadband(input))
        } else {
            self.beyond_deadband(taken(input))
        };
        self.ratio * self.curve.map_or(left, |curve| curve.of(left))
    }

    /// The input after the dead band.
    #[inline]
    fn beyond_deadband(&self, input: f64) -> f64 {
        let off = input - self.deadband_skew * self.deadband;
        if off.abs() <= self.deadband {
            return 0.0;
        }
        let edge = (off.signum() + self.deadband_skew) * self.deadband;
        input - (1.0 - self.deadband_jump) * edge
    }

    /// Steady-state torque at the joint per unit of `input`, at a velocity, N m per unit of input.
    #[inline]
    pub fn gain(&self, input: f64, velocity: f64) -> f64 {
        if self.is_linear(input.abs()) {
            self.ratio
        } else if input == 0.0 {
            0.0
        } else {
            self.settled_at(input, velocity) / input
        }
    }
}

/// Longest piece of a torque behind two lags, as a share of the first lag's time constant. Within a piece, the output of the
/// first lag is replaced by a straight line with the same mean. The error is then a thirtieth of the remaining step
/// response.
const STRAIGHT: f64 = 0.5;

/// State of a drive: the torques within the delay, and the states of the lags.
#[derive(Clone, Debug)]
pub struct DriveLine {
    slew: Option<Slew>,
    delay_s: f64,
    lag_s: f64,
    further_lag_s: f64,
    under_way: VecDeque<(f64, Torque)>,
    torque: Torque,
    /// Time for which `torque` has been acting, s.
    age_s: f64,
    /// Torque after the second lag, N m.
    acting_nm: f64,
}

impl DriveLine {
    /// The state at rest after a long time with zero input.
    pub fn at_rest(drive: &Drive) -> Self {
        Self {
            slew: Slew::at_rest(drive),
            delay_s: drive.delay_s,
            lag_s: drive.lag_s,
            further_lag_s: drive.further_lag_s,
            under_way: VecDeque::new(),
            torque: Torque::held(0.0),
            age_s: 0.0,
            acting_nm: 0.0,
        }
    }

    /// Commands `input` from `now_s` while the drive moves at `velocity`. Times must not decrease from call to call.
    #[inline]
    pub fn command(&mut self, drive: &Drive, now_s: f64, input: f64, velocity: f64) {
        let settled_nm = drive.settled_at(input, velocity);
        self.receive(now_s, Torque::held(settled_nm));
    }

    /// The same as [`Self::command`] for a motor that produces the torque `made` from the commanded `input`.
    ///
    /// Limit and dead band act on the commanded input, as without a motor. If the drive has a lag too, it is combined with
    /// the lag of the motor into one lag with the sum of both time constants.
    #[inline]
    pub fn command_through(
        &mut self,
        drive: &Drive,
        now_s: f64,
        input: f64,
        velocity: f64,
        made: Torque,
    ) {
        self.receive(now_s, made.scaled(drive.gain(input, velocity)));
    }

    #[inline]
    fn receive(&mut self, now_s: f64, settled: Torque) {
        match self.slew {
            Some(slew) => self.slew_towards(slew, now_s, settled),
            None => self.pass(now_s, settled),
        }
    }

    /// Starts a ramp towards a torque.
    #[inline(never)]
    fn slew_towards(&mut self, mut slew: Slew, now_s: f64, settled: Torque) {
        let (ramp, until_s) = slew.towards(settled.target_nm, now_s);
        self.slew = Some(slew);
        // The end of a previous ramp is cancelled.
        let comes_s = now_s + self.delay_s;
        while self.under_way.back().is_some_and(|(at, _)| *at >= comes_s) {
            self.under_way.pop_back();
        }
        self.pass(now_s, ramp);
        if !ramp.is_held() {
            let reached = Torque::held(settled.target_nm);
            self.under_way.push_back((until_s + self.delay_s, reached));
        }
    }

    /// Passes a torque through the delay.
    #[inline]
    fn pass(&mut self, now_s: f64, torque: Torque) {
        if self.delay_s > 0.0 {
            self.under_way.push_back((now_s + self.delay_s, torque));
        } else {
            self.take(torque);
        }
    }

    #[inline]
    fn take(&mut self, settled: Torque) {
        self.torque = if self.lag_s > 0.0 {
            Torque {
                start_nm: self.torque.at(self.age_s),
                lag_s: self.lag_s + settled.lag_s,
                ..settled
            }
        } else {
            settled
        };
        self.age_s = 0.0;
    }

    /// The torque from `now_s` on, and the part of the next `dt_s` for which it is smooth. It must be called until `dt_s` is
    /// used up.
    // Inlined, because returning the result in memory slows every step.
    #[inline(always)]
    pub fn piece(&mut self, now_s: f64, dt_s: f64) -> (Torque, f64) {
        while let Some(&(at, target)) = self.under_way.front() {
            // An arrival within the rounding error of now counts as now. Otherwise a piece could be empty.
            if at - now_s > f64::EPSILON * now_s.abs().max(dt_s) {
                break;
            }
            self.take(target);
            self.under_way.pop_front();
        }
        let piece_s = match self.under_way.front() {
            Some(&(at, _)) => dt_s.min(at - now_s),
            None => dt_s,
        };
        if self.age_s > 0.0 {
            self.torque = self.torque.after(self.age_s);
        }
        if self.further_lag_s > 0.0 {
            return self.piece_behind(piece_s);
        }
        self.age_s = piece_s;
        (self.torque, piece_s)
    }

    /// Advances a plant by `dt_s` under the torque of the commands. Their times use the clock of `state`.
    #[inline]
    pub fn carry(&mut self, plant: &Plant, state: &mut State, dt_s: f64) {
        let mut left_s = dt_s;
        while left_s > 0.0 {
            let (torque, piece_s) = self.piece(state.time_s, left_s);
            plant.advance(state, torque, piece_s);
            left_s -= piece_s;
        }
    }

    /// The torque after the second lag for the next `piece_s`, and the time for which it is one smooth piece.
    fn piece_behind(&mut self, piece_s: f64) -> (Torque, f64) {
        let (piece_s, decay) = if self.torque.is_held() {
            (piece_s, 0.0)
        } else {
            let piece_s = piece_s.min(STRAIGHT * self.lag_s);
            (piece_s, (-piece_s / self.lag_s).exp())
        };
        self.age_s = piece_s;
        let behind = self
            .torque
            .behind(self.acting_nm, self.further_lag_s, piece_s, decay);
        self.acting_nm = behind.at(piece_s);
        (behind, piece_s)
    }
}

/// A torque with a limited rate.
#[derive(Clone, Copy, Debug)]
pub struct Slew {
    rate_nm_s: f64,
    /// Time at which the present ramp started, s.
    since_s: f64,
    from_nm: f64,
    target_nm: f64,
}

impl Slew {
    /// A ramp at rest with zero torque. `None` if the drive has no rate limit.
    pub fn at_rest(drive: &Drive) -> Option<Self> {
        let rate_nm_s = drive.rate_limit_nm_s();
        rate_nm_s.is_finite().then_some(Self {
            rate_nm_s,
            since_s: 0.0,
            from_nm: 0.0,
            target_nm: 0.0,
        })
    }

    /// Sets the torque, N m.
    pub fn stand_at(&mut self, torque_nm: f64) {
        (self.from_nm, self.target_nm) = (torque_nm, torque_nm);
    }

    /// Torque at a later time, N m.
    fn at(&self, time_s: f64) -> f64 {
        let most_nm = self.rate_nm_s * (time_s - self.since_s).max(0.0);
        self.from_nm + (self.target_nm - self.from_nm).clamp(-most_nm, most_nm)
    }

    /// Starts a ramp to another target. Returns the ramp and the time of its end, s.
    fn towards(&mut self, target_nm: f64, now_s: f64) -> (Torque, f64) {
        self.from_nm = self.at(now_s);
        self.since_s = now_s;
        self.target_nm = target_nm;
        let way_nm = target_nm - self.from_nm;
        if way_nm == 0.0 || self.rate_nm_s == 0.0 {
            return (Torque::held(self.from_nm), now_s);
        }
        let ramp = Torque {
            target_rate_nm_s: self.rate_nm_s.copysign(way_nm),
            ..Torque::held(self.from_nm)
        };
        (ramp, now_s + way_nm.abs() / self.rate_nm_s)
    }

    /// Starts a ramp to another target. Returns the mean torque from `now_s` to `end_s`, N m.
    pub fn mean_towards(&mut self, target_nm: f64, now_s: f64, end_s: f64) -> f64 {
        let (ramp, there_s) = self.towards(target_nm, now_s);
        let lasts_s = end_s - now_s;
        let moves_s = (there_s.min(end_s) - now_s).max(0.0);
        if lasts_s <= 0.0 || !lasts_s.is_finite() {
            return self.from_nm;
        }
        let moved_nm = ramp.target_rate_nm_s * moves_s;
        self.from_nm + moved_nm * (1.0 - 0.5 * moves_s / lasts_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_limit_ramps_to_each_input_and_a_new_input_ends_the_ramp() {
        let drive = Drive {
            rate_limit: 10.0,
            ..Drive::ideal(2.0)
        };
        let mut line = DriveLine::at_rest(&drive);
        let mut now_s = 0.0;
        let mut seen = Vec::new();
        for (input, lasts_s) in [(1.0, 0.2), (-1.0, 0.05), (1.0, 0.02)] {
            line.command(&drive, now_s, input, 0.0);
            let end_s = now_s + lasts_s;
            while end_s - now_s > 1e-12 {
                let (torque, piece_s) = line.piece(now_s, end_s - now_s);
                now_s += piece_s;
                seen.push(torque.at(piece_s));
            }
        }
        let expected = [2.0, 2.0, 1.0, 1.4];
        let pairs = seen.iter().zip(expected);
        assert!(
            seen.len() == 4 && pairs.clone().all(|(s, e)| (s - e).abs() < 1e-9),
            "{seen:?}"
        );
    }

    #[test]
    fn the_mean_of_a_ramp_counts_what_comes_after_it() {
        let drive = Drive {
            rate_limit: 10.0,
            ..Drive::ideal(1.0)
        };
        let mut slew = Slew::at_rest(&drive).expect("a limit");
        let mean = slew.mean_towards(1.0, 0.0, 0.2);
        assert!((mean - 0.75).abs() < 1e-12, "{mean}");
        let mean = slew.mean_towards(-9.0, 0.2, 0.3);
        assert!((mean - 0.5).abs() < 1e-12, "{mean}");
    }

    fn line(drive: &Drive, inputs: &[f64], tick_s: f64) -> Vec<(f64, Torque)> {
        let mut line = DriveLine::at_rest(drive);
        let mut pieces = Vec::new();
        for (i, &input) in inputs.iter().enumerate() {
            let mut now = i as f64 * tick_s;
            let end = now + tick_s;
            line.command(drive, now, input, 0.0);
            while end - now > 1e-12 {
                let (torque, piece) = line.piece(now, end - now);
                pieces.push((now, torque));
                now += piece;
            }
        }
        pieces
    }

    /// Asserts the settled torque, N m, for each input.
    fn assert_settled(drive: &Drive, expected: &[(f64, f64)]) {
        for &(input, torque) in expected {
            let settled = drive.settled(input);
            assert!(
                (settled - torque).abs() < 1e-12,
                "{input}: {settled} for {torque}"
            );
        }
    }

    #[test]
    fn a_curve_of_the_input_passes_its_reference_and_has_a_dead_zone() {
        let drive = Drive {
            curve: Some(InputCurve {
                gain: 1.2,
                power: 0.5,
                dead_zone: 0.1,
                reference: 0.9,
                knee: 0.5,
                slope_beyond: 1.0,
            }),
            ..Drive::ideal(2.0)
        };
        assert_settled(
            &drive,
            &[(0.05, 0.0), (0.9, 2.16), (-0.9, -2.16), (0.3, 1.08)],
        );
        assert!(!drive.is_linear(0.01));
    }

    #[test]
    fn a_curve_of_the_input_has_another_slope_beyond_its_knee() {
        let drive = Drive {
            curve: Some(InputCurve {
                gain: 1.0,
                power: 1.0,
                dead_zone: 0.0,
                reference: 1.0,
                knee: 0.5,
                slope_beyond: 0.25,
            }),
            ..Drive::ideal(1.0)
        };
        assert_settled(&drive, &[(0.25, 0.4), (0.5, 0.8), (-1.0, -1.0), (2.0, 1.4)]);
    }

    #[test]
    fn the_limit_acts_before_or_after_the_dead_band() {
        let drive = Drive {
            limit: 0.5,
            deadband: 0.1,
            ..Drive::ideal(10.0)
        };
        assert_eq!(drive.settled(0.05), 0.0);
        assert!((drive.settled(-0.3) + 2.0).abs() < 1e-12);
        assert!((drive.settled(7.0) - 4.0).abs() < 1e-12);
        let jumping = Drive {
            deadband_jump: 1.0,
            ..drive
        };
        assert_eq!(jumping.settled(-0.1), 0.0);
        assert!((jumping.settled(-0.3) + 3.0).abs() < 1e-12);
        let skewed = Drive {
            deadband_skew: 0.5,
            ..jumping.clone()
        };
        assert_eq!([skewed.settled(0.15), skewed.settled(-0.05)], [0.0; 2]);
        assert!((skewed.settled(0.2) - 2.0).abs() < 1e-12);
        let starting = Drive {
            deadband_jump: 0.0,
            ..skewed
        };
        assert!((starting.settled(0.3) - 1.5).abs() < 1e-12);
        assert!((starting.settled(-0.3) + 2.5).abs() < 1e-12);
        let first = Drive {
            deadband_first: true,
            ..drive
        };
        assert!((first.settled(-0.3) + 2.0).abs() < 1e-12);
        assert!((first.settled(7.0) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_drive_with_negative_ratio_weakens_with_the_motion_that_it_causes() {
        let drive = |ratio| Drive {
            saturation: Saturation {
                limit: 1.0,
                no_load_velocity: 4.0,
                ..Saturation::NONE
            },
            ..Drive::ideal(ratio)
        };
        let [usual, turned] = [2.0, -2.0].map(drive);
        for velocity in [-3.0, 0.0, 1.0, 3.0] {
            let mirrored = turned.settled_at(0.8, -velocity);
            assert_eq!(usual.settled_at(0.8, velocity), -mirrored);
        }
        assert!(turned.settled_at(0.8, -3.0).abs() < turned.settled_at(0.8, 3.0).abs());
    }

    #[test]
    fn a_knee_rounds_the_transition_to_the_limit() {
        let soft = Saturation {
            limit: 2.0,
            knee: 0.5,
            ..Saturation::NONE
        };
        let hard = Saturation { knee: 0.0, ..soft };
        for (input, bent, clipped) in [
            (0.9, 0.9, 0.9),
            (1.0, 1.0, 1.0),
            (2.0, 1.75, 2.0),
            (3.0, 2.0, 2.0),
            (9.0, 2.0, 2.0),
        ] {
            assert_eq!([soft.of(input), hard.of(input)], [bent, clipped]);
        }
        let slope = |at: f64| (soft.of(at + 1e-6) - soft.of(at - 1e-6)) / 2e-6;
        assert!((slope(1.0) - 1.0).abs() < 1e-6 && slope(3.0).abs() < 1e-6);
        assert_eq!(Saturation::NONE.of(1e9), 1e9);
        let drive = Drive {
            saturation: soft,
            ..Drive::ideal(1.0)
        };
        assert!(drive.is_linear(1.0) && !drive.is_linear(1.1));
    }

    #[test]
    fn a_voltage_limit_falls_with_the_velocity_in_the_direction_of_the_input() {
        let drive = Drive {
            saturation: Saturation {
                limit: 2.0,
                no_load_velocity: 10.0,
                ..Saturation::NONE
            },
            ..Drive::ideal(3.0)
        };
        assert!(!drive.is_linear(0.1));
        for (input, velocity, torque) in [
            (1.0, 4.0, 3.0),
            (5.0, 4.0, 3.6),
            (-5.0, -4.0, -3.6),
            (-5.0, 5.0, -9.0),
            (1.0, 12.0, 0.0),
        ] {
            assert!((drive.settled_at(input, velocity) - torque).abs() < 1e-12);
        }
    }

    #[test]
    fn a_delay_of_one_and_a_half_ticks_divides_a_tick_into_two_pieces() {
        let drive = Drive {
            delay_s: 1.5e-3,
            ..Drive::ideal(1.0)
        };
        let pieces = line(&drive, &[1.0, 2.0, 3.0], 1e-3);
        let seen: Vec<_> = pieces.iter().map(|(_, t)| t.target_nm).collect();
        assert_eq!(seen, [0.0, 0.0, 1.0, 1.0, 2.0]);
        assert!((pieces[2].0 - 1.5e-3).abs() < 1e-12);
    }

    #[test]
    fn the_step_response_of_two_lags_matches_their_equation() {
        // y = 1 − (τ₁ e^(−t/τ₁) − τ₂ e^(−t/τ₂)) / (τ₁ − τ₂)
        let [first, further] = [3e-3, 1e-3];
        let drive = Drive {
            lag_s: first,
            further_lag_s: further,
            ..Drive::ideal(1.0)
        };
        let mut line = DriveLine::at_rest(&drive);
        let (mut now, mut impulse) = (0.0, 0.0);
        line.command(&drive, now, 1.0, 0.0);
        while now < 0.02 {
            let (torque, piece_s) = line.piece(now, 1e-3);
            let left = |lag_s: f64| lag_s * (-now / lag_s).exp();
            let expected = 1.0 - (left(first) - left(further)) / (first - further);
            assert!((torque.at(0.0) - expected).abs() < 3e-3, "at {now}");
            let (_, mean) = torque.end_and_mean(piece_s, (-piece_s / further).exp());
            impulse += mean * piece_s;
            now += piece_s;
        }
        // The integral of the remaining step response is the sum of the lags.
        assert!((now - impulse - first - further).abs() < 2e-5);
    }

    #[test]
    fn a_lag_in_several_pieces_equals_a_lag_in_one_piece() {
        let drive = Drive {
            lag_s: 2e-3,
            ..Drive::ideal(1.0)
        };
        let pieces = line(&drive, &[1.0; 5], 1e-3);
        let end = pieces.last().unwrap().1.at(1e-3);
        assert!((end - (1.0 - (-2.5f64).exp())).abs() < 1e-12);
    }
}
