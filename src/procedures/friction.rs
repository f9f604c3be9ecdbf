//! The friction experiment of the report (section 3.1.1): the torque grows until the paddle moves. It is repeated in both
//! directions and at several angles.
//!
//! A soft position loop makes the torque. Its setpoint moves away from the sticking paddle, so that the torque grows with
//! it. Once the paddle moves, it follows the setpoint by some tenths of a degree and no farther.
//!
//! Gravity and springs pull the paddle towards one angle. They appear as a slope over the angle that is equal in both
//! directions, and are not counted as friction. A constant torque cannot be told from friction that is larger in one
//! direction.

use core::fmt;

use super::{Finding, Outcome, ProcedureError};
use crate::console::Device;
use crate::decimal::Fixed;
use crate::scalar::limit;
use crate::settings::{DerivativeSource, Settings};
use crate::units::{DEG_PER_RAD, RAD_PER_DEG};

/// Proportional gain of the soft loop. It gives a natural frequency of some 40 rad/s, with half the critical damping.
const STIFFNESS_NM_PER_DEG: f32 = 0.02;
const DAMPING_NM_S_PER_DEG: f32 = 0.0004;
/// Angles at which the friction is measured, rad.
const ANGLES_RAD: [f32; 3] = [0.0, 10.0 * RAD_PER_DEG, -10.0 * RAD_PER_DEG];
/// Number of measurements per angle and direction.
const REPEATS: usize = 2;
const VALUES: usize = ANGLES_RAD.len() * REPEATS;
/// Motion that counts as a start, rad: eight encoder counts, more than slack and presliding.
const MOVED_RAD: f32 = 0.1 * RAD_PER_DEG;
/// Torque limit of the measurement, N m at the motor: a third of the motor's torque limit, above any friction of a paddle.
const MOST_NM: f32 = 0.010;
/// Rate of the torque in the first measurement, N m/s at the motor.
const FIRST_RATE_NM_PER_S: f32 = 1.0e-3;
/// Later measurements start at this share of the known friction. The torque then grows by this share per second. The inertia
/// of the moving paddle adds about 1 %.
const KNOWN_SHARE: f32 = 0.6;
const SHARE_PER_S: f32 = 0.3;
/// Rate of the torque up to that start, N m/s at the motor.
const APPROACH_NM_PER_S: f32 = 4.0e-3;
/// Speed of the setpoint between angles, rad/s.
const TRAVEL_RAD_S: f32 = 20.0 * RAD_PER_DEG;
/// Rest before each measurement and after each motion, s.
const REST_S: f32 = 0.3;

/// Changes the settings for the soft loop.
pub fn adapt(settings: &mut Settings) {
    let pid = &mut settings.pid;
    pid.kp_nm_per_deg = STIFFNESS_NM_PER_DEG;
    pid.ki_nm_per_deg_s = 0.0;
    pid.kd_nm_s_per_deg = DAMPING_NM_S_PER_DEG;
    pid.setpoint_weight = 1.0;
    pid.derivative = DerivativeSource::Position;
    settings.motor.torque_limit_nm = (1.2 * MOST_NM).min(settings.motor.torque_limit_nm);
    settings.limit.travel_deg = settings.limit.travel_deg.min(25.0);
    settings.limit.speed_deg_s = settings.limit.speed_deg_s.min(300.0);
}

/// Direction of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Forward,
    Backward,
}

impl Way {
    fn sign(self) -> f32 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Forward => Self::Backward,
            Self::Backward => Self::Forward,
        }
    }
}

/// Friction in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// Mean, N m at the motor.
    pub mean_nm: f32,
    /// Standard deviation of a single measurement, N m at the motor.
    pub deviation_nm: f32,
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} +- {}",
            Fixed(self.mean_nm * 1e3, 3),
            Fixed(self.deviation_nm * 1e3, 3)
        )
    }
}

/// The result of the procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionFinding {
    /// Friction in the positive direction.
    pub forward: Level,
    /// Friction in the negative direction.
    pub backward: Level,
    /// Stiffness of gravity and springs, N m/rad at the paddle.
    pub pull_nm_per_rad: f32,
}

impl fmt::Display for FrictionFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "friction forward {} mN m, backward {} mN m at the motor ({VALUES} values each, at 0, 10 and -10 deg)\r\n\
             gravity and springs: {} N m/rad at the paddle\r\n\
             to compensate it, a little less: set compensation.dry_forward {}; set compensation.dry_backward {}",
            self.forward,
            self.backward,
            Fixed(self.pull_nm_per_rad, 4),
            Fixed(0.9 * self.forward.mean_nm, 6),
            Fixed(0.9 * self.backward.mean_nm, 6)
        )
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// The setpoint moves to the angle.
    Going,
    /// The paddle comes to rest, for this remaining time, s.
    Resting(f32),
    /// The torque grows. It started with the encoder at `from_rad`, rad, and has reached at most `most_nm`, N m.
    Pushing { from_rad: f32, most_nm: f32 },
}

/// The running procedure.
#[derive(Clone, Debug)]
pub struct Friction {
    rad_per_nm: f32,
    rad_per_s: f32,
    setpoint_rad: Option<f32>,
    place: usize,
    repeat: usize,
    way: Way,
    stage: Stage,
    /// Friction known so far in both directions, N m at the motor. The first measurements only set the start of the later
    /// ones.
    known_nm: [Option<f32>; 2],
    values: [[Value; VALUES]; 2],
}

/// One measurement: the torque that started the motion, N m at the motor, and the angle, rad.
#[derive(Clone, Copy, Debug, Default)]
struct Value {
    angle_rad: f32,
    torque_nm: f32,
}

impl Friction {
    /// Starts the procedure with the user's settings.
    pub fn new(users: &Settings) -> Self {
        let nm_per_rad = STIFFNESS_NM_PER_DEG * DEG_PER_RAD / users.mechanism.ratio;
        Self {
            rad_per_nm: 1.0 / nm_per_rad,
            rad_per_s: TRAVEL_RAD_S,
            setpoint_rad: None,
            place: 0,
            repeat: 0,
            way: Way::Forward,
            stage: Stage::Going,
            known_nm: [None; 2],
            values: [[Value::default(); VALUES]; 2],
        }
    }

    /// See [`super::Procedure::advance`].
    #[inline(never)]
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        let (position_rad, torque_nm) = device.with(|c| (c.encoder_rad(), c.torque_command_nm()));
        let mut setpoint_rad = *self.setpoint_rad.get_or_insert(position_rad);
        let sign = self.way.sign();
        match self.stage {
            Stage::Going => {
                let target_rad = *ANGLES_RAD.get(self.place)?;
                let step_rad = self.rad_per_s * elapsed_s;
                let left_rad = target_rad - setpoint_rad;
                if left_rad.abs() <= step_rad {
                    self.stage = Stage::Resting(REST_S);
                }
                setpoint_rad += limit(left_rad, step_rad);
            }
            Stage::Resting(left_s) if left_s > 0.0 => {
                self.stage = Stage::Resting(left_s - elapsed_s);
            }
            Stage::Resting(_) => {
                self.stage = Stage::Pushing {
                    from_rad: position_rad,
                    most_nm: f32::NEG_INFINITY,
                };
            }
            Stage::Pushing { from_rad, most_nm } => {
                let push_nm = sign * torque_nm;
                if sign * (position_rad - from_rad) > MOVED_RAD {
                    if let Some(outcome) = self.take(Value {
                        angle_rad: from_rad,
                        torque_nm: sign * most_nm,
                    }) {
                        return Some(outcome);
                    }
                } else if push_nm > MOST_NM {
                    return Some(Err(ProcedureError::DoesNotMove { torque_nm: push_nm }));
                } else {
                    self.stage = Stage::Pushing {
                        // If the paddle still swings back, the start angle follows it.
                        from_rad: if sign * (position_rad - from_rad) < 0.0 {
                            position_rad
                        } else {
                            from_rad
                        },
                        most_nm: most_nm.max(push_nm),
                    };
                    setpoint_rad +=
                        sign * self.rad_per_nm * self.rate_nm_per_s(push_nm) * elapsed_s;
                }
            }
        }
        self.setpoint_rad = Some(setpoint_rad);
        // The reference is refused only after a fault, which the console reports.
        let _ = device.with(|c| c.set_reference(setpoint_rad));
        None
    }

    /// Present rate of the torque, N m/s.
    fn rate_nm_per_s(&self, push_nm: f32) -> f32 {
        match self.known_nm.get(self.way as usize).copied().flatten() {
            None if push_nm < 0.0 => APPROACH_NM_PER_S,
            None => FIRST_RATE_NM_PER_S,
            Some(known_nm) if push_nm < KNOWN_SHARE * known_nm => APPROACH_NM_PER_S,
            Some(known_nm) => SHARE_PER_S * known_nm,
        }
    }

    /// Stores a measurement and goes on to the next one. Returns the outcome after the last.
    fn take(&mut self, value: Value) -> Option<Outcome> {
        let known = self.known_nm.get_mut(self.way as usize)?;
        let first = known.replace(self.way.sign() * value.torque_nm).is_none();
        if !first {
            let row = self.values.get_mut(self.way as usize)?;
            *row.get_mut(self.place * REPEATS + self.repeat)? = value;
        }
        let backward = self.way == Way::Backward;
        self.way = self.way.other();
        self.stage = Stage::Resting(REST_S);
        if !backward || first {
            return None;
        }
        self.repeat += 1;
        if self.repeat == REPEATS {
            self.repeat = 0;
            self.place += 1;
            self.stage = Stage::Going;
        }
        (self.place == ANGLES_RAD.len()).then(|| Ok(Finding::Friction(self.conclude())))
    }

    fn conclude(&self) -> FrictionFinding {
        let means = self.values.map(|row| {
            let sum = row.iter().fold(Value::default(), |sum, value| Value {
                angle_rad: sum.angle_rad + value.angle_rad,
                torque_nm: sum.torque_nm + value.torque_nm,
            });
            Value {
                angle_rad: sum.angle_rad / VALUES as f32,
                torque_nm: sum.torque_nm / VALUES as f32,
            }
        });
        let (mut over, mut under) = (0.0, 0.0);
        for (row, mean) in self.values.iter().zip(means) {
            for value in row {
                let angle_rad = value.angle_rad - mean.angle_rad;
                over += angle_rad * (value.torque_nm - mean.torque_nm);
                under += angle_rad * angle_rad;
            }
        }
        let slope = over / under;
        let [forward, backward] = [(0, 1.0), (1, -1.0)].map(|(way, sign)| {
            let (Some(row), Some(mean)) = (self.values.get(way), means.get(way)) else {
                return Level::default();
            };
            let mean_nm = mean.torque_nm - slope * mean.angle_rad;
            let squares: f32 = row
                .iter()
                .map(|value| value.torque_nm - slope * value.angle_rad - mean_nm)
                .map(|rest| rest * rest)
                .sum();
            Level {
                mean_nm: sign * mean_nm,
                deviation_nm: libm::sqrtf(squares / (VALUES - 1) as f32),
            }
        });
        FrictionFinding {
            forward,
            backward,
            // The torque at the paddle is larger than at the motor by this ratio.
            pull_nm_per_rad: slope * STIFFNESS_NM_PER_DEG * DEG_PER_RAD * self.rad_per_nm,
        }
    }
}
