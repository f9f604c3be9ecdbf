//! Two masses and the spring and damper between them under constant forces, in closed form.

use super::link::{Flank, Link};

/// The relative motion of the two sides of a link, and the share of each side in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwoMass {
    mobility: [f64; 2],
    stiffness: f64,
    damping: f64,
    relaxed: f64,
    /// Share of each side in the sum of both mobilities.
    share: [f64; 2],
    /// The relative motion: its decay rate, 1/s, and the square of its undamped angular frequency, 1/s².
    decay_rate: f64,
    rate_squared: f64,
    /// Square of the damped angular frequency, 1/s²; negative if the motion is overdamped.
    discriminant: f64,
    /// Root of the discriminant's size, 1/s, and its inverse, s.
    rate: f64,
    rate_s: f64,
}

/// The free relative motion over some time.
#[derive(Clone, Copy)]
pub(super) struct Propagator {
    cosine: f64,
    sine_s: f64,
    time_s: f64,
}

/// The relative motions of a link, by flank and by the sides that friction holds.
#[derive(Clone, Debug, Default)]
pub(super) struct Modes(Vec<TwoMass>);

/// Flanks and held sides in the order of [`Modes`].
const FLANKS: [Flank; 4] = [
    Flank::Apart,
    Flank::Pushing(-1.0),
    Flank::Pushing(1.0),
    Flank::Bound,
];
const HELD: [[bool; 2]; 4] = [[false, false], [true, false], [false, true], [true, true]];
/// Number of combinations of flank and held sides.
pub(super) const FLOWS: usize = FLANKS.len() * HELD.len();

/// Index of a flank with motor side or load side held.
#[inline]
pub(super) fn flow_index(flank: Flank, held: [bool; 2]) -> usize {
    let flank = match flank {
        Flank::Apart => 0,
        Flank::Pushing(side) => 1 + usize::from(side > 0.0),
        Flank::Bound => 3,
    };
    HELD.len() * flank + usize::from(held[0]) + 2 * usize::from(held[1])
}

impl Modes {
    /// The motions of a link between two sides of these inverse inertias, 1/(kg m²).
    pub(super) fn of(link: &Link, inverse_inertia: [f64; 2]) -> Self {
        let mode = |flank: Flank, held: [bool; 2]| {
            let (stiffness, damping, relaxed) = link.spring(flank);
            let mobility = |side: usize| {
                if held[side] {
                    0.0
                } else {
                    inverse_inertia[side]
                }
            };
            TwoMass::new([mobility(0), mobility(1)], stiffness, damping, relaxed)
        };
        let modes = FLANKS
            .iter()
            .flat_map(|&flank| HELD.map(|held| mode(flank, held)));
        Self(modes.collect())
    }

    /// The motion on a flank, with motor side or load side held.
    #[inline]
    pub(super) fn within(&self, flank: Flank, held: [bool; 2]) -> &TwoMass {
        &self.0[flow_index(flank, held)]
    }
}

impl TwoMass {
    /// `mobility` is the inverse inertia of motor side and load side, 1/(kg m²), 0 for one that is held. `stiffness`, N
    /// m/rad, and `damping`, N m s/rad, are those between the sides, 0 inside a play. `relaxed` is the twist at which
    /// the spring is relaxed, rad.
    fn new(mobility: [f64; 2], stiffness: f64, damping: f64, relaxed: f64) -> Self {
        let sum = mobility[0] + mobility[1];
        let rate_squared = sum * stiffness;
        let decay_rate = 0.5 * sum * damping;
        let discriminant = rate_squared - decay_rate * decay_rate;
        let rate = discriminant.abs().sqrt();
        Self {
            mobility,
            stiffness,
            damping,
            relaxed,
            share: mobility.map(|one| one / sum),
            decay_rate,
            rate_squared,
            discriminant,
            rate,
            rate_s: rate.recip(),
        }
    }

    /// Angle of the undamped relative oscillation over a time, rad.
    #[inline]
    pub(super) fn angle(&self, time_s: f64) -> f64 {
        self.rate_squared.sqrt() * time_s
    }

    /// The free relative motion over `time_s`: the impulse response of a damped oscillator and its derivative.
    #[inline]
    pub(super) fn propagator(&self, time_s: f64) -> Propagator {
        let Self {
            decay_rate,
            discriminant,
            rate,
            rate_s,
            ..
        } = *self;
        let angle = rate * time_s;
        let (cosine, sine_s) = if angle < SMALL_ANGLE {
            let decay = (-decay_rate * time_s).exp();
            let square = discriminant * time_s * time_s;
            (
                decay * (1.0 - 0.5 * square),
                decay * time_s * (1.0 - square / 6.0),
            )
        } else if discriminant > 0.0 {
            let decay = (-decay_rate * time_s).exp();
            let (sine, cosine) = angle.sin_cos();
            (decay * cosine, decay * sine * rate_s)
        } else {
            let slow = ((rate - decay_rate) * time_s).exp();
            let fast = (-(rate + decay_rate) * time_s).exp();
            (0.5 * (slow + fast), 0.5 * (slow - fast) * rate_s)
        };
        Propagator {
            cosine: cosine + decay_rate * sine_s,
            sine_s,
            time_s,
        }
    }

    /// The free relative motion over twice the time.
    #[inline]
    pub(super) fn twice(&self, over: &Propagator) -> Propagator {
        let Propagator {
            cosine: c,
            sine_s: s,
            time_s,
        } = *over;
        Propagator {
            cosine: c * c - self.rate_squared * s * s,
            sine_s: 2.0 * s * (c - self.decay_rate * s),
            time_s: 2.0 * time_s,
        }
    }

    /// Torque from the motor side on the load side, N m.
    #[inline]
    pub(super) fn torque(&self, x: &[f64; 4]) -> f64 {
        self.stiffness * (x[0] - x[2] - self.relaxed) + self.damping * (x[1] - x[3])
    }

    /// Accelerations by torques on motor side and load side, rad/s².
    #[inline]
    pub(super) fn pushed(&self, torques_nm: [f64; 2]) -> [f64; 2] {
        [
            self.mobility[0] * torques_nm[0],
            self.mobility[1] * torques_nm[1],
        ]
    }

    /// Accelerations by the link alone, rad/s².
    #[inline]
    pub(super) fn accelerations(&self, x: &[f64; 4]) -> [f64; 2] {
        let torque = self.torque(x);
        self.pushed([-torque, torque])
    }

    /// State `[position, velocity]` of motor and load side after the time of a `propagator`. All torques but the link's
    /// accelerate them by `acceleration`, rad/s².
    #[inline]
    pub(super) fn carried(
        &self,
        propagator: &Propagator,
        x: &[f64; 4],
        acceleration: [f64; 2],
    ) -> [f64; 4] {
        let share = self.share;
        // The centre of mass, or the side that is held, does not feel the link.
        let centre = |motor: f64, load: f64| share[1] * motor + share[0] * load;
        let t = propagator.time_s;
        let pull = centre(acceleration[0], acceleration[1]);
        let velocity = centre(x[1], x[3]) + t * pull;
        let position = centre(x[0], x[2]) + t * (velocity - 0.5 * t * pull);
        let relative = acceleration[0] - acceleration[1];
        let twisted = [x[0] - x[2] - self.relaxed, x[1] - x[3]];
        let [twist, rate] = self.relative(propagator, twisted, relative);
        let twist = twist + self.relaxed;
        [
            position + share[0] * twist,
            velocity + share[0] * rate,
            position - share[1] * twist,
            velocity - share[1] * rate,
        ]
    }

    /// Twist from the relaxed one and its rate, under a constant relative acceleration.
    #[inline]
    fn relative(&self, over: &Propagator, [twist, rate]: [f64; 2], acceleration: f64) -> [f64; 2] {
        let falling = over.cosine - 2.0 * self.decay_rate * over.sine_s;
        let bent = self.bent_s2(over);
        [
            over.cosine * twist + over.sine_s * rate + bent * acceleration,
            falling * rate + over.sine_s * (acceleration - self.rate_squared * twist),
        ]
    }

    /// Twist per constant relative acceleration, s²: the integral of the impulse response.
    #[inline]
    fn bent_s2(&self, over: &Propagator) -> f64 {
        let t = over.time_s;
        if self.rate_squared * t * t > SMALL_ANGLE.powi(4) {
            (1.0 - over.cosine) / self.rate_squared
        } else if self.decay_rate * t > SMALL_ANGLE {
            (t - over.sine_s) / (2.0 * self.decay_rate)
        } else {
            0.5 * t * t
        }
    }
}

/// Angle of an oscillation up to which the error of its expansion is below 1e-9, rad.
const SMALL_ANGLE: f64 = 1e-2;

#[cfg(test)]
mod tests {
    use super::super::runge_kutta::rk4;
    use super::*;
    use proptest::prelude::*;

    /// The motion in a thousand steps of Runge and Kutta.
    fn stepped(link: &TwoMass, mut x: [f64; 4], acceleration: [f64; 2], time_s: f64) -> [f64; 4] {
        const STEPS: usize = 1000;
        let h = time_s / STEPS as f64;
        let rate = |_: f64, x: &[f64; 4]| {
            let [motor, load] = link.accelerations(x);
            [x[1], acceleration[0] + motor, x[3], acceleration[1] + load]
        };
        for _ in 0..STEPS {
            x = rk4(rate, &x, &rate(0.0, &x), h).0;
        }
        x
    }

    proptest! {
        #[test]
        fn the_closed_form_equals_numerical_integration(
            held in 0usize..3,
            natural in 0.0..3.0f64,
            damping_ratio in 0.0..4.0f64,
            relaxed in -0.1..0.1f64,
            motor in -5.0..5.0f64,
            load in -5.0..5.0f64,
        ) {
            let time_s = 1e-3;
            let mut mobility = [3.0, 7.0];
            if held < 2 {
                mobility[held] = 0.0;
            }
            let sum = mobility[0] + mobility[1];
            let rate = natural / time_s;
            let stiffness = rate * rate / sum;
            let damping = 2.0 * damping_ratio * rate / sum;
            let link = TwoMass::new(mobility, stiffness, damping, relaxed);
            let mut x = [0.2, 3.0, 0.15, -2.0];
            let mut acceleration = [motor, load];
            if held < 2 {
                x[2 * held + 1] = 0.0;
                acceleration[held] = 0.0;
            }
            let exact = stepped(&link, x, acceleration, time_s);
            let half = link.propagator(0.5 * time_s);
            for propagator in [link.propagator(time_s), link.twice(&half)] {
                let closed = link.carried(&propagator, &x, acceleration);
                for (i, scale) in [1.0, 1.0 / time_s, 1.0, 1.0 / time_s].into_iter().enumerate() {
                    prop_assert!((closed[i] - exact[i]).abs() < 1e-7 * scale, "{closed:?} {exact:?}");
                }
            }
        }
    }

    #[test]
    fn inside_the_play_both_sides_move_freely() {
        let free = TwoMass::new([2.0, 1.0], 0.0, 0.0, 0.0);
        let x = free.carried(&free.propagator(0.5), &[0.0, 1.0, 1.0, -1.0], [2.0, 4.0]);
        let flown = [0.75, 2.0, 1.0, 1.0];
        assert!(
            x.iter().zip(flown).all(|(a, b)| (a - b).abs() < 1e-12),
            "{x:?}"
        );
    }
}
