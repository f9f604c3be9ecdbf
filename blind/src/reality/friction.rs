//! Friction at the joint.

use core::f64::consts::PI;
use recording::Model;

use super::{Motion, REST};

/// How the Coulomb friction depends on position: its level is multiplied by `1 + amount * shape`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Profile {
    /// `amount * (x - at) / scale`
    Linear { amount: f64, at: f64, scale: f64 },
    /// `amount * ((x - at) / scale)^2`
    Quadratic { amount: f64, at: f64, scale: f64 },
    /// `amount * sin((x - at) / scale)`
    Wave { amount: f64, at: f64, scale: f64 },
    /// `amount` at `at`, falling like a squared cosine to zero at the distance `scale`
    Spot { amount: f64, at: f64, scale: f64 },
}

impl Profile {
    fn factor(self, x: f64) -> f64 {
        let factor = match self {
            Self::Linear { amount, at, scale } => amount * (x - at) / scale,
            Self::Quadratic { amount, at, scale } => amount * ((x - at) / scale).powi(2),
            Self::Wave { amount, at, scale } => amount * ((x - at) / scale).sin(),
            Self::Spot { amount, at, scale } => {
                let away = ((x - at) / scale).clamp(-1.0, 1.0);
                amount * (0.5 * PI * away).cos().powi(2)
            }
        };
        (1.0 + factor).max(0.0)
    }
}

/// How the Coulomb friction changes over the session: its level is multiplied by a factor that depends on time.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WarmUp {
    /// The factor `1 + amount` is reached at `over_s`. The change continues at the same rate.
    Linear {
        amount: f64,
        over_s: f64,
    },
    Exponential {
        amount: f64,
        time_constant_s: f64,
    },
    /// The factor changes to `1 + amount` around `at_s`, as a hyperbolic tangent of width `within_s`.
    Step {
        amount: f64,
        at_s: f64,
        within_s: f64,
    },
    /// The factor starts at `1 + amount` and decays to 1.
    FromCold {
        amount: f64,
        time_constant_s: f64,
    },
}

impl WarmUp {
    fn factor(self, time_s: f64) -> f64 {
        let factor = match self {
            Self::Linear { amount, over_s } => amount * time_s / over_s,
            Self::Exponential {
                amount,
                time_constant_s,
            } => amount * -(-time_s / time_constant_s).exp_m1(),
            Self::Step {
                amount,
                at_s,
                within_s,
            } => 0.5 * amount * (1.0 + ((time_s - at_s) / within_s).tanh()),
            Self::FromCold {
                amount,
                time_constant_s,
            } => amount * (-time_s / time_constant_s).exp(),
        };
        (1.0 + factor).max(0.0)
    }
}

/// Presliding: bristles of `stiffness` (N m/rad) that bend before they slip. They are purely elastic below `elastic_share`
/// of the deflection at which they slip (Dupont et al., "Single state elastoplastic friction models", 2002). With an
/// `elastic_share` of 0 it is the LuGre model (Canudas de Wit et al., 1995).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bristle {
    pub stiffness: f64,
    pub damping: f64,
    pub elastic_share: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Friction {
    /// Coulomb friction while sliding in the positive direction, N m. `backward` is that in the negative direction.
    pub forward: f64,
    pub backward: f64,
    /// Static over Coulomb friction.
    pub static_ratio: f64,
    /// Stribeck velocity `vs`, and the exponent in `exp(-|v / vs|^power)`.
    pub stribeck_velocity: f64,
    pub stribeck_power: i32,
    pub viscous: f64,
    /// Drag `-c v |v|`.
    pub quadratic: f64,
    pub profile: Option<Profile>,
    pub warm_up: Option<WarmUp>,
    /// Additional dry friction per unit of torque that the transmission carries.
    pub load_share: f64,
    /// Factor on `load_share` where the load drives the motor.
    pub backdriven: f64,
    /// If true, the carried torque includes that of gravity and springs.
    pub carries_all: bool,
    pub bristle: Option<Bristle>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    /// Deflection of the bristles.
    deflection: f64,
}

/// Dry friction in each direction at one instant, N m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    forward: f64,
    backward: f64,
}

impl Friction {
    pub fn plain(model: &Model) -> Self {
        Self {
            forward: model.coulomb,
            backward: model.coulomb,
            static_ratio: 1.0,
            stribeck_velocity: 1.0,
            stribeck_power: 1,
            viscous: model.viscous,
            quadratic: 0.0,
            profile: None,
            warm_up: None,
            load_share: 0.0,
            backdriven: 1.0,
            carries_all: false,
            bristle: None,
        }
    }

    /// The dry friction for this motion, carried torque and time.
    pub fn level(&self, motion: Motion, carried: f64, time_s: f64) -> Level {
        let mut factor = 1.0;
        if self.static_ratio != 1.0 {
            let ratio = motion.v.abs() / self.stribeck_velocity;
            factor += (self.static_ratio - 1.0) * (-ratio.powi(self.stribeck_power)).exp();
        }
        if let Some(profile) = self.profile {
            factor *= profile.factor(motion.x);
        }
        if let Some(warm_up) = self.warm_up {
            factor *= warm_up.factor(time_s);
        }
        let driven = self.load_share * carried.abs();
        let backdriven = self.backdriven * driven;
        let [forward, backward] = if carried < 0.0 {
            [backdriven, driven]
        } else {
            [driven, backdriven]
        };
        Level {
            forward: self.forward * factor + forward,
            backward: self.backward * factor + backward,
        }
    }

    /// Velocity after a step of `dt` under the torque `free` and the given `share` of all friction, bristles included.
    #[expect(clippy::too_many_arguments)]
    pub fn resist(
        &self,
        memory: &mut Memory,
        free: f64,
        v: f64,
        inertia: f64,
        level: Level,
        share: f64,
        dt: f64,
    ) -> f64 {
        let Some(bristle) = self.bristle else {
            return self.project(free, v, inertia, level, share, dt);
        };
        let slip = if v >= 0.0 {
            level.forward
        } else {
            level.backward
        } / bristle.stiffness;
        let z = memory.deflection;
        let sliding = if slip <= 0.0 {
            0.0
        } else if bristle.elastic_share == 0.0 {
            1.0
        } else if z * v <= 0.0 {
            0.0
        } else {
            let bent = (z / slip).abs();
            let share =
                ((bent - bristle.elastic_share) / (1.0 - bristle.elastic_share)).clamp(0.0, 1.0);
            0.5 + 0.5 * (std::f64::consts::PI * (share - 0.5)).sin()
        };
        // The exact solution for constant velocity is stable at any speed.
        memory.deflection = if sliding > 0.0 {
            let settled = v.signum() * slip / sliding;
            settled + (z - settled) * (-sliding * v.abs() * dt / slip).exp()
        } else {
            z + v * dt
        };
        memory.deflection = memory
            .deflection
            .clamp(-slip.max(z.abs()), slip.max(z.abs()));
        let rate = (memory.deflection - z) / dt;
        let bent = bristle.stiffness * 0.5 * (z + memory.deflection) + bristle.damping * rate;
        self.dragged(free - share * bent, v, inertia, share, dt)
    }

    /// Velocity after a step of `dt` under `free`, with set-valued dry friction. It is zero where the friction can stop the
    /// motion within the step.
    pub fn project(
        &self,
        free: f64,
        v: f64,
        inertia: f64,
        level: Level,
        share: f64,
        dt: f64,
    ) -> f64 {
        let v = self.dragged(free, v, inertia, share, dt);
        let forward = share * level.forward * dt / inertia;
        let backward = share * level.backward * dt / inertia;
        if v > forward {
            v - forward
        } else if v < -backward {
            v + backward
        } else {
            0.0
        }
    }

    /// Velocity after a step of `dt` under `free` and drag. Viscous friction uses the trapezoidal rule, quadratic drag is
    /// explicit.
    fn dragged(&self, free: f64, v: f64, inertia: f64, share: f64, dt: f64) -> f64 {
        let half = 0.5 * share * self.viscous * dt / inertia;
        let drag = if v.abs() > REST {
            share * self.quadratic * v * v.abs()
        } else {
            0.0
        };
        (v * (1.0 - half) + (free - drag) * dt / inertia) / (1.0 + half)
    }
}
