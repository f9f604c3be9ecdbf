//! A regime that is too stiff for a classical step. The drive and all torques that are linear in the positions and
//! velocities are stepped exactly. All others are held at their values in the middle of the step (the exponential
//! Rosenbrock midpoint rule: Hochbruck and Ostermann, Acta Numerica 19, 2010).

use super::linear_load::LinearLoad;
use super::link::Flank;
use super::zero_order_hold::{ZeroOrderHold, combined};
use super::{Phase, Plant, State, Torque};

/// Most parts of a step. An oscillation faster than [`TURN`] in such a part is not followed; the rows of a log do not
/// show it either.
pub(super) const MOST_DIVISIONS: f64 = 64.0;
/// Most events within one step. More of them are chatter.
pub(super) const MOST_EVENTS: usize = 64;
/// Factor by which a classical step must be longer than the step to be used for a fast oscillation. Its phase error is
/// then 1e-4 instead of 3e-3 of the angle.
pub(super) const BEYOND_CLASSICAL: f64 = 2.5;
/// Accuracy of the instant of an event, as a share of the step. A fast oscillation has many events in a log.
pub(super) const EVENT_TOLERANCE: f64 = 1e-9;
/// Product of the fastest rate of the nonlinear part and the step.
const BENT_RATE_STEP: f64 = 0.2;
/// Product of the rate of an inertia on bristles and the step. Bristles yield as they bend.
const BRISTLE_ANGLE: f64 = 0.2;
/// Largest angle of an oscillation in a step, rad, where a mass may stop or strike: it then does so once at most.
pub(super) const TURN: f64 = 0.5 * core::f64::consts::PI;

/// Rates of a linear flow, by columns. Its state is position and velocity of each mass, then the two parts of the
/// drive: the one that decays and the one that grows evenly, N m.
#[derive(Clone, Copy, Debug)]
pub(super) enum Linear {
    One([[f64; 4]; 4]),
    Two([[f64; 6]; 6]),
}

impl Linear {
    /// The linear flow of a plant in a state. `linked` is the flank of the link and the sides that friction holds;
    /// `None` without a link.
    pub(super) fn of(
        plant: &Plant,
        state: &State,
        torque: &Torque,
        linked: Option<(Flank, [bool; 2])>,
    ) -> Self {
        let linear_load = LinearLoad::of(plant, state);
        let damping = plant.damping(state);
        let fades = if torque.lag_s > 0.0 {
            -torque.lag_s.recip()
        } else {
            0.0
        };
        let bristles = plant.bristle_spring(state);
        match linked {
            Some((flank, held)) => {
                let mut four = plant.two_mass_rates(flank, held, &linear_load, damping);
                let motor = if held[0] {
                    0.0
                } else {
                    plant.inverse_inertia[0]
                };
                four[0][1] -= motor * bristles.stiffness;
                four[1][1] -= motor * bristles.damping;
                Self::Two(driven(&four, motor, fades))
            }
            None => {
                let linear_load = LinearLoad {
                    stiffness: linear_load.stiffness + bristles.stiffness,
                    damping: linear_load.damping + bristles.damping,
                    ..linear_load
                };
                let two = plant.one_mass_rates(&linear_load, damping[0]);
                Self::One(driven(&two, plant.inverse_inertia[0], fades))
            }
        }
    }
}

/// The rates of masses, extended by the drive, which acts on the first mass.
fn driven<const M: usize, const D: usize>(
    masses: &[[f64; M]; M],
    motor: f64,
    fades: f64,
) -> [[f64; D]; D] {
    let mut rates = [[0.0; D]; D];
    for (column, of_masses) in rates.iter_mut().zip(masses) {
        column[..M].copy_from_slice(of_masses);
    }
    for drive in &mut rates[M..] {
        drive[1] = motor;
    }
    rates[M][M] = fades;
    rates
}

/// A step of a linear flow under nonlinear torques.
pub(super) struct Step<const D: usize, const S: usize> {
    hold: ZeroOrderHold<D, S>,
    from: [f64; D],
    /// Rate at which the drive grows, N m/s.
    grows: f64,
}

impl<const D: usize, const S: usize> Step<D, S> {
    /// A step over `step_s` from these positions and velocities of the masses.
    pub(super) fn new(rates: &[[f64; D]; D], masses: &[f64], torque: &Torque, step_s: f64) -> Self {
        let mut inputs = [[0.0; D]; S];
        for (mass, input) in inputs.iter_mut().enumerate() {
            // The last input is the growth of the drive.
            let acts_on = if mass + 1 < S { 2 * mass + 1 } else { D - 1 };
            input[acts_on] = 1.0;
        }
        let mut from = [0.0; D];
        from[..D - 2].copy_from_slice(masses);
        let (fading, steady, grows) = torque.parts();
        (from[D - 2], from[D - 1]) = (fading, steady);
        Self {
            hold: ZeroOrderHold::new(*rates, inputs, step_s),
            from,
            grows,
        }
    }

    /// Accelerations of the masses by the linear flow, under a drive, rad/s².
    fn pulled(&self, rates: &[[f64; D]; D], at: &[f64; D], drive_nm: f64) -> [f64; D] {
        let mut at = *at;
        (at[D - 2], at[D - 1]) = (0.0, drive_nm);
        combined(rates, &at)
    }

    fn forces(&self, accelerations: [f64; 2]) -> [f64; S] {
        core::array::from_fn(|i| {
            if i + 1 < S {
                accelerations[i]
            } else {
                self.grows
            }
        })
    }

    /// The state of the masses and their accelerations in the middle and at the end of the step. `total` is the
    /// acceleration by all torques: at the start, and under a drive in the middle.
    pub(super) fn taken(
        &self,
        rates: &[[f64; D]; D],
        start: [f64; 2],
        mean_nm: f64,
        halfway: impl Fn(&[f64; D], f64) -> [f64; 2],
    ) -> ([f64; D], [f64; D]) {
        let rest = |total: [f64; 2], pulled: [f64; D]| {
            core::array::from_fn(|mass| {
                let velocity = 2 * mass + 1;
                if velocity < D - 2 {
                    total[mass] - pulled[velocity]
                } else {
                    0.0
                }
            })
        };
        let drive_nm = self.from[D - 2] + self.from[D - 1];
        let first = rest(start, self.pulled(rates, &self.from, drive_nm));
        let midway = self.hold.half.of(&self.from, &self.forces(first));
        let total = halfway(&midway, mean_nm);
        let acting = self.forces(rest(total, self.pulled(rates, &midway, mean_nm)));
        let end = self.hold.whole.of(&self.from, &acting);
        let mut end_rate = combined(rates, &end);
        for (mass, force) in acting[..S - 1].iter().enumerate() {
            end_rate[2 * mass + 1] += force;
        }
        (end, end_rate)
    }
}

/// Spring and damper of bristles at their present deflection.
#[derive(Clone, Copy, Default)]
struct BristleSpring {
    /// Stiffness, N m/rad.
    stiffness: f64,
    /// Damping, N m s/rad.
    damping: f64,
}

impl Plant {
    /// Slope of the viscous friction and of the drag of motor side and load side at their present velocities, N m s/rad.
    #[inline]
    fn damping(&self, state: &State) -> [f64; 2] {
        let m = &self.mechanics;
        let speeds = [state.velocity, state.load_velocity].map(f64::abs);
        core::array::from_fn(|side| {
            self.friction_share[side] * (m.viscous + 2.0 * m.drag * speeds[side])
        })
    }

    fn bristle_spring(&self, state: &State) -> BristleSpring {
        if !self.parts.has_bristles || !self.dry || state.phase != Phase::Bristle {
            return BristleSpring::default();
        }
        let bristles = &self.parts.bristles;
        // At rest the bristles bend in either direction.
        let bends = match state.velocity {
            0.0 => 1.0,
            velocity => bristles.rate(velocity, state.deflection) / velocity,
        };
        let level_nm = self.mechanics.friction.highest_nm();
        BristleSpring {
            stiffness: bends * level_nm / bristles.distance,
            damping: bends * bristles.damping,
        }
    }

    /// Rate at which quadratic drag slows a side, 1/s, at its present speed or at the speed to which it is pulled.
    pub(super) fn drag_rate(&self, state: &State, drive_nm: f64) -> f64 {
        let pull_nm = self.pull(state, drive_nm, self.through(state)).abs();
        let speed = state.velocity.abs().max(state.load_velocity.abs());
        let rate = |side: usize| {
            let drag = self.friction_share[side] * self.mechanics.drag;
            2.0 * (drag * speed).max((drag * pull_nm).sqrt()) * self.inverse_inertia[side]
        };
        if self.parts.has_link {
            rate(0).max(rate(1))
        } else {
            rate(0)
        }
    }

    /// Change of the rate at which quadratic drag slows a side until its torques balance, 1/s. The linear part of a step contains the rate at
    /// the present speed.
    fn drag_bend_rate(&self, state: &State, drive_nm: f64) -> f64 {
        let through = self.through(state);
        let of_side = |side: usize, speed: f64, pull_nm: f64| {
            let drag = self.friction_share[side] * self.mechanics.drag;
            (pull_nm / speed).min(2.0 * (drag * pull_nm).sqrt()) * self.inverse_inertia[side]
        };
        let pull_nm = self.pull(state, drive_nm, through).abs();
        let motor = of_side(0, state.velocity.abs(), pull_nm);
        if !self.parts.has_link {
            return motor;
        }
        let pull_nm = self.load_pull(state, through).abs();
        motor.max(of_side(1, state.load_velocity.abs(), pull_nm))
    }

    /// The longest step of a stiff regime, s.
    pub(super) fn longest_stiff_step(&self, state: &State, torque: &Torque) -> f64 {
        let m = &self.mechanics;
        let mobility = self.highest_mobility();
        let bent = (m.bent_stiffness() * mobility).sqrt();
        let mut longest = BENT_RATE_STEP / bent;
        if m.drag != 0.0 {
            longest = longest.min(BENT_RATE_STEP / self.drag_bend_rate(state, torque.at(0.0)));
        }
        if self.dry || !self.parts.barriers.is_empty() || self.parts.has_link {
            let linear_load = LinearLoad::of(self, state);
            let bristles = self.bristle_spring(state).stiffness;
            let stiffness = linear_load.stiffness.abs() + bristles;
            let damping = m.viscous + linear_load.damping;
            if bristles > 0.0 {
                // The time in which a mass bends the bristles, limited by its inertia or by its damping.
                let natural_s = (bristles * mobility).sqrt().recip();
                longest = longest.min(BRISTLE_ANGLE * natural_s.max(damping / bristles));
            }
            longest = longest.min(TURN / self.turning_rate(stiffness, damping));
        }
        longest
    }

    /// Angular frequency of the masses on a linear load and on their link, rad/s. A velocity changes its sign once in a
    /// part of a turn at most.
    pub(super) fn turning_rate(&self, stiffness: f64, damping: f64) -> f64 {
        let mobility = self.highest_mobility();
        if self.parts.has_link {
            let link = self.parts.link.natural_rate(self.mechanics.inertia);
            return (stiffness * mobility).sqrt() + link;
        }
        let half = 0.5 * damping * mobility;
        (stiffness * mobility - half * half).max(0.0).sqrt()
    }
}
