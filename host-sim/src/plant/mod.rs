//! The paddle as one inertia on one axis, with everything that acts on it at the joint.
//!
//! ```text
//! J x'' = T(t) + offset − B x' − Q x'|x'| − G sin(x − x_G) − K (x − x_K)
//!         + A sin(n x + φ) + … + barriers − dry friction
//! ```
//!
//! A transmission that is not rigid splits it into motor side and load side.
//!
//! Between events the right-hand side is smooth and is stepped at fourth order; stick, slip and
//! contact begin and end at events that are located, not stepped over.

mod advance;
mod barrier;
mod cascade;
mod cogging;
mod drift;
mod error_deadband;
mod event;
mod fading;
mod follower;
mod friction;
mod glide;
mod law;
mod linear_load;
mod link;
mod pace;
mod parts;
mod pendulum;
mod presliding;
mod pull;
mod regime;
mod runge_kutta;
mod spot;
mod sticking;
mod stiff;
mod stribeck;
mod torque;
mod torque_profile;
mod two_mass;
mod zero_order_hold;

use pace::{CLOSED_LINK_STEP, CLOSED_RATE_STEP, EXACT, Pace, QUICK};
use parts::Parts;
use pendulum::Pendulum;
use two_mass::Modes;

pub use barrier::{Barrier, Touch};
pub use cascade::Cascade;
pub use cogging::{Cogging, FURTHER, Wave};
pub use drift::Drift;
pub(crate) use error_deadband::error_deadband;
pub use follower::Follower;
pub use friction::Friction;
pub use law::{Law, Moment, TorqueLaw};
pub use link::Link;
pub use presliding::Presliding;
pub use spot::Spot;
use stribeck::Slope;
pub use stribeck::Stribeck;
use torque::Push;
pub use torque::Torque;
pub use torque_profile::TorqueProfile;

/// Number of barriers that a plant can have: two stops, four contacts and three pushes.
pub const BARRIERS: usize = 9;

/// Everything that acts on the joint. Angles in rad (or the recording's unit of position).
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanics {
    /// Inertia of the joint with the motor's rotor, kg m².
    pub inertia: f64,
    /// Viscous friction, N m s/rad.
    pub viscous: f64,
    /// Quadratic drag, N m s²/rad².
    pub drag: f64,
    /// Weight times lever, N m.
    pub gravity: f64,
    /// Position at which the joint hangs at rest, rad.
    pub gravity_zero: f64,
    /// Angle of one unit of position, rad.
    pub angle_rad: f64,
    /// Stiffness of the spring, N m/rad.
    pub stiffness: f64,
    /// Position at which the spring is relaxed, rad.
    pub stiffness_zero: f64,
    /// Hardening of the spring: at a distance d its torque is 1 + `hardening` d² times the linear one, 1/rad².
    pub hardening: f64,
    /// Constant torque, N m.
    pub offset_nm: f64,
    /// Dry friction.
    pub friction: Friction,
    /// Elastic part of the dry friction, if any. The friction then bends bristles instead of sticking.
    pub presliding: Option<Presliding>,
    /// Transmission that is not rigid, if any.
    pub link: Option<Link>,
    /// Torque ripple over position.
    pub cogging: Option<Cogging>,
    /// Hard stops and contacts.
    pub barriers: [Option<Barrier>; BARRIERS],
    /// Torques that are given as laws.
    pub laws: Vec<Law>,
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
            angle_rad: 1.0,
            stiffness: 0.0,
            stiffness_zero: 0.0,
            hardening: 0.0,
            offset_nm: 0.0,
            friction: Friction::coulomb(0.0),
            presliding: None,
            link: None,
            cogging: None,
            barriers: [None; BARRIERS],
            laws: Vec::new(),
        }
    }

    /// Natural frequencies plus damping of the smooth part without the link, 1/s.
    fn fastest_rate(&self) -> f64 {
        let stiffness = self.stiffness.abs() + self.bent_stiffness();
        (stiffness / self.inertia).sqrt() + self.viscous.abs() / self.inertia
    }

    /// Natural frequency plus damping by the spring and viscous friction alone, 1/s. The two sides have these inverse
    /// inertias, 1/(kg m²), and shares of the friction.
    fn spring_rate(&self, inverse_inertia: [f64; 2], friction_share: [f64; 2]) -> f64 {
        let damped =
            |side: usize| friction_share[side] * self.viscous.abs() * inverse_inertia[side];
        (self.stiffness.abs() * inverse_inertia[1]).sqrt() + damped(0).max(damped(1))
    }

    /// Torque of all laws in the middle of the next `dt_s`, N m.
    pub(crate) fn by_laws(
        &self,
        [position, velocity]: [f64; 2],
        drive_nm: f64,
        time_s: f64,
        dt_s: f64,
    ) -> f64 {
        let half_s = 0.5 * dt_s;
        let laws = self.laws.iter();
        laws.map(|law| {
            law.torque_nm(
                position + half_s * velocity,
                velocity,
                drive_nm,
                time_s + half_s,
            )
        })
        .sum()
    }

    /// True if gravity or a spring pulls.
    pub fn is_pulled(&self) -> bool {
        self.gravity != 0.0 || self.stiffness != 0.0
    }

    /// Largest slope of the nonlinear torques, N m/rad. The hardening of a spring is assumed to add less than its
    /// stiffness.
    fn bent_stiffness(&self) -> f64 {
        let cogging = self.cogging.map_or(0.0, |cogging| cogging.stiffness());
        let hardened = if self.hardening == 0.0 {
            0.0
        } else {
            self.stiffness.abs()
        };
        self.gravity.abs() * self.angle_rad + cogging + hardened
    }

    /// Angle from where it hangs at rest, rad.
    #[inline]
    pub fn from_hanging_rad(&self, position: f64) -> f64 {
        self.angle_rad * (position - self.gravity_zero)
    }

    /// Nonlinear part of the spring's torque at a position, N m.
    #[inline]
    fn hardened(&self, position: f64) -> f64 {
        if self.hardening == 0.0 {
            return 0.0;
        }
        -self.stiffness * self.hardening * (position - self.stiffness_zero).powi(3)
    }

    /// Torque of the spring at a position, N m.
    #[inline]
    pub fn spring(&self, position: f64) -> f64 {
        -self.stiffness * (position - self.stiffness_zero) + self.hardened(position)
    }
}

/// How dry friction acts at the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Held at rest.
    Stick,
    /// On bristles that bend.
    Bristle,
    /// Sliding in the positive direction.
    Forward,
    /// Sliding in the negative direction.
    Backward,
}

impl Phase {
    /// The phase at a velocity, without bristles.
    fn sliding(velocity: f64) -> Self {
        if velocity > 0.0 {
            Self::Forward
        } else if velocity < 0.0 {
            Self::Backward
        } else {
            Self::Stick
        }
    }

    /// Direction of sliding: ±1; 0 if nothing slides.
    #[inline]
    fn direction(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
            Self::Stick | Self::Bristle => 0.0,
        }
    }
}

/// State of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Time since the start of the session, s.
    pub time_s: f64,
    /// Position of the motor side, rad. With a rigid transmission it is that of the joint.
    pub position: f64,
    /// Velocity of the motor side, rad/s.
    pub velocity: f64,
    /// Position of the load side, rad, where the transmission is not rigid.
    pub load_position: f64,
    /// Velocity of the load side, rad/s.
    pub load_velocity: f64,
    /// Deflection of the bristles, rad.
    pub deflection: f64,
    /// State of the dry friction on the motor side.
    pub phase: Phase,
    /// State of the dry friction on the load side.
    pub load_phase: Phase,
    touch: [Touch; BARRIERS],
    pendulum: Pendulum,
    rest: Rest,
}

/// A resting joint. It changes with the position alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rest {
    position: f64,
    /// Torque without the drive, N m.
    pull_nm: f64,
    /// Lowest and highest drive that does not break the joint away, N m, where friction holds by a level that depends on
    /// position and direction alone.
    holds_nm: [f64; 2],
}

impl Rest {
    /// The torque has not been computed yet.
    const UNKNOWN: Self = Self {
        position: f64::INFINITY,
        pull_nm: 0.0,
        holds_nm: [0.0; 2],
    };
}

/// A plant that is ready to be stepped.
#[derive(Clone, Debug)]
pub struct Plant {
    mechanics: Mechanics,
    dry: bool,
    /// Share of the friction on the motor side and on the load side of the link.
    friction_share: [f64; 2],
    /// `is_level`: dry friction depends on direction and time alone. `plain`: it depends on the direction alone.
    is_level: bool,
    plain: bool,
    parts: Parts,
    /// True if barriers come and go, or friction steps, at known instants.
    is_timed: bool,
    /// True if the torque on a resting joint depends on position and drive alone, apart from barriers that come and go.
    rest_is_steady: bool,
    /// True if the level of friction at rest depends on position and direction alone.
    holds_steadily: bool,
    inverse_inertia: [f64; 2],
    link_modes: Modes,
    pace: Pace,
    /// Fall of friction with speed on the motor side and on the load side.
    slopes: Option<[Slope; 2]>,
    /// Fastest rate of spring and viscous friction, 1/s.
    spring_rate: f64,
    longest_step_s: f64,
    longest_closed_step_s: f64,
    longest_glide_s: f64,
}

impl Plant {
    /// A plant that steps as far as the mechanics allow.
    pub fn new(mechanics: Mechanics) -> Self {
        Self::with_pace(mechanics, EXACT)
    }

    /// A plant that takes longer steps where something is stiff, for comparison with a noisy sensor. Their error is
    /// 1e-3 of the change within a step.
    pub fn quick(mechanics: Mechanics) -> Self {
        Self::with_pace(mechanics, QUICK)
    }

    fn with_pace(mechanics: Mechanics, pace: Pace) -> Self {
        let dry = !mechanics.friction.is_none();
        let parts = Parts::of(&mechanics);
        let steps = mechanics.friction.drift.is_some_and(|d| d.step != 0.0);
        let is_timed = steps || parts.barriers.iter().any(|b| b.during_s.is_some());
        let rate = mechanics.fastest_rate();
        let of_link = |rate: fn(&Link, f64) -> f64| {
            let link = mechanics.link.as_ref();
            link.map_or(0.0, |link| rate(link, mechanics.inertia))
        };
        let inverse_inertia = match &mechanics.link {
            Some(link) => [
                1.0 / (mechanics.inertia * (1.0 - link.load_share)),
                1.0 / (mechanics.inertia * link.load_share),
            ],
            None => [1.0 / mechanics.inertia; 2],
        };
        let friction_share = match &mechanics.link {
            Some(link) if mechanics.presliding.is_none() => {
                [1.0 - link.load_friction, link.load_friction]
            }
            _ => [1.0, 0.0],
        };
        let Friction { stribeck, .. } = &mechanics.friction;
        let slope = |side: usize| {
            let level_nm = friction_share[side] * mechanics.friction.highest_nm();
            stribeck.slope(inverse_inertia[side].recip(), level_nm)
        };
        let link_modes = |link: &Link| Modes::of(link, inverse_inertia);
        let closed_link_step_s = CLOSED_LINK_STEP / of_link(Link::natural_rate);
        Self {
            dry,
            friction_share,
            is_level: mechanics.friction.is_level(),
            plain: mechanics.friction.is_level() && mechanics.friction.drift.is_none(),
            parts,
            is_timed,
            rest_is_steady: dry && mechanics.link.is_none() && mechanics.presliding.is_none(),
            holds_steadily: mechanics.friction.drift.is_none()
                && mechanics.friction.is_without_load_share(),
            inverse_inertia,
            slopes: (!stribeck.is_none()).then(|| [0, 1].map(slope)),
            link_modes: mechanics.link.as_ref().map(link_modes).unwrap_or_default(),
            pace,
            spring_rate: mechanics.spring_rate(inverse_inertia, friction_share),
            longest_step_s: pace.rate_step / (rate + of_link(Link::fastest_rate)),
            longest_glide_s: match pace.glide_rate_step {
                Some(rate_step) if mechanics.link.is_none() => rate_step / rate,
                _ => 0.0,
            },
            longest_closed_step_s: (CLOSED_RATE_STEP / rate).min(closed_link_step_s),
            mechanics,
        }
    }

    /// A plant with steps of at most `longest_step_s`, for studies of convergence.
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

    /// The state at a position and velocity of the position sensor. Link and bristles, which the sensor does not see,
    /// are relaxed.
    pub fn state(&self, time_s: f64, position: f64, velocity: f64) -> State {
        let mut state = State {
            time_s,
            position,
            velocity,
            load_position: position,
            load_velocity: velocity,
            deflection: 0.0,
            phase: Phase::Stick,
            load_phase: Phase::Stick,
            touch: [Touch::Free; BARRIERS],
            pendulum: Pendulum::about(self.mechanics.from_hanging_rad(position)),
            rest: Rest::UNKNOWN,
        };
        self.enter(&mut state);
        state
    }

    /// The state at a newly measured position and velocity. The twist of the link and the deflection of the bristles,
    /// which the sensor does not see, are taken from `before`.
    pub fn restart(&self, before: &State, time_s: f64, position: f64, velocity: f64) -> State {
        let (seen, seen_rate) = self.seen(before);
        let (shift, shift_rate) = (position - seen, velocity - seen_rate);
        let mut state = State {
            time_s,
            position: before.position + shift,
            velocity: before.velocity + shift_rate,
            load_position: before.load_position + shift,
            load_velocity: before.load_velocity + shift_rate,
            ..*before
        };
        self.enter(&mut state);
        state
    }

    /// Position and velocity on the side that has the position sensor, rad and rad/s.
    #[inline]
    pub fn seen(&self, state: &State) -> (f64, f64) {
        if self.parts.has_link && self.parts.link.sensor_on_load {
            (state.load_position, state.load_velocity)
        } else {
            (state.position, state.velocity)
        }
    }

    /// Sets phase and contacts after positions and velocities were set from outside.
    fn enter(&self, state: &mut State) {
        let slid = state.deflection * state.velocity.signum();
        let Parts {
            has_bristles,
            bristles,
            ..
        } = &self.parts;
        // At rest the bristles bend, whatever their deflection: the joint does not slide yet.
        let bends = *has_bristles && (state.velocity == 0.0 || slid < bristles.distance);
        state.phase = if bends {
            Phase::Bristle
        } else {
            Phase::sliding(state.velocity)
        };
        state.load_phase = Phase::sliding(state.load_velocity);
        self.touch(state);
    }

    fn touch(&self, state: &mut State) {
        let (position, velocity) = if self.parts.has_link {
            (state.load_position, state.load_velocity)
        } else {
            (state.position, state.velocity)
        };
        for (touch, barrier) in state.touch.iter_mut().zip(&self.parts.barriers) {
            *touch = if barrier.is_there(state.time_s) {
                barrier.touch(position, velocity)
            } else {
                Touch::Free
            };
        }
    }
}
