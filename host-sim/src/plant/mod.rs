//! The paddle as one inertia on one axis, with everything that acts on it at the joint.
//!
//! ```text
//! J x'' = T(t) + offset − B x' − Q x'|x'| − G sin(x − x_G) − K (x − x_K)
//!         + A sin(n x + φ) + barriers − dry friction
//! ```
//!
//! Between events the right-hand side is smooth and is stepped at fourth order; stick, slip and
//! contact begin and end at events that are located, not stepped over.

mod barrier;
mod friction;
mod rigid;
mod runge_kutta;
mod torque;

pub use barrier::{Barrier, Touch};
pub use friction::Friction;
pub use torque::Torque;

/// Most barriers that a plant can have: two stops and something outside.
pub const BARRIERS: usize = 3;

/// Torque that varies sinusoidally with position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cogging {
    /// Amplitude, N m.
    pub amplitude_nm: f64,
    /// Periods per radian times 2π.
    pub wave_number: f64,
    /// Phase at position zero, rad.
    pub phase: f64,
}

/// Everything that acts on the joint. Angles in rad (or the recording's unit of position).
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanics {
    /// Of the joint, motor rotor included, kg m².
    pub inertia: f64,
    /// N m s/rad.
    pub viscous: f64,
    /// N m s²/rad².
    pub drag: f64,
    /// Weight times lever, N m.
    pub gravity: f64,
    /// Where it hangs at rest, rad.
    pub gravity_zero: f64,
    /// N m/rad.
    pub stiffness: f64,
    /// Where the spring is relaxed, rad.
    pub stiffness_zero: f64,
    /// Constant torque, N m.
    pub offset_nm: f64,
    /// Dry friction.
    pub friction: Friction,
    /// Torque ripple over position.
    pub cogging: Option<Cogging>,
    /// Hard stops and contacts.
    pub barriers: [Option<Barrier>; BARRIERS],
}

impl Mechanics {
    /// A free inertia.
    pub fn inertia(inertia: f64) -> Self {
        Self {
            inertia,
            viscous: 0.0,
            drag: 0.0,
            gravity: 0.0,
            gravity_zero: 0.0,
            stiffness: 0.0,
            stiffness_zero: 0.0,
            offset_nm: 0.0,
            friction: Friction::coulomb(0.0),
            cogging: None,
            barriers: [None; BARRIERS],
        }
    }

    /// Of the smooth part, 1/s: natural frequency plus damping.
    fn fastest_rate(&self) -> f64 {
        let cogging = self.cogging.map_or(0.0, |c| c.amplitude_nm * c.wave_number);
        let stiffness = self.gravity.abs() + self.stiffness.abs() + cogging.abs();
        (stiffness / self.inertia).sqrt() + self.viscous.abs() / self.inertia
    }
}

/// How dry friction acts at the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Held at rest.
    Stick,
    /// Sliding the positive way.
    Forward,
    /// Sliding the negative way.
    Backward,
}

/// State of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Since the start of the session, s.
    pub time_s: f64,
    /// rad.
    pub position: f64,
    /// rad/s.
    pub velocity: f64,
    /// Of the dry friction.
    pub phase: Phase,
    touch: [Touch; BARRIERS],
}

/// A plant that is ready to be stepped.
#[derive(Clone, Debug)]
pub struct Plant {
    mechanics: Mechanics,
    dry: bool,
    plain: bool,
    longest_step_s: f64,
}

/// Product of the fastest rate of a regime and the step: a fourth-order step then errs by less than
/// 1e-7 of what changes within it.
const RATE_STEP: f64 = 0.1;

impl Plant {
    /// Steps as long as the mechanics allow.
    pub fn new(mechanics: Mechanics) -> Self {
        Self {
            dry: !mechanics.friction.is_none(),
            plain: mechanics.friction.is_plain(),
            longest_step_s: RATE_STEP / mechanics.fastest_rate(),
            mechanics,
        }
    }

    /// Steps of at most `longest_step_s`, for studies of convergence.
    pub fn with_longest_step(mechanics: Mechanics, longest_step_s: f64) -> Self {
        let plant = Self::new(mechanics);
        Self {
            longest_step_s: plant.longest_step_s.min(longest_step_s),
            ..plant
        }
    }

    /// What acts on the joint.
    pub fn mechanics(&self) -> &Mechanics {
        &self.mechanics
    }

    /// The state at a position and velocity; friction takes it from there.
    pub fn state(&self, time_s: f64, position: f64, velocity: f64) -> State {
        let touch = core::array::from_fn(|i| match &self.mechanics.barriers[i] {
            Some(barrier) => barrier.touch(position, velocity),
            None => Touch::Free,
        });
        let phase = if velocity > 0.0 {
            Phase::Forward
        } else if velocity < 0.0 {
            Phase::Backward
        } else {
            Phase::Stick
        };
        State {
            time_s,
            position,
            velocity,
            phase,
            touch,
        }
    }
}
