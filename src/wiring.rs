//! Check of the wiring before the position loop is armed. A small torque of the motor must turn encoder and Hall sensor in
//! the positive direction. With a wrong sign, the loop would run away.

use core::fmt;

use crate::units::RAD_PER_DEG;

/// Torque of the push, N m at the motor: three times the dry friction of a paddle, a sixth of the motor's torque limit.
pub const PUSH_NM: f32 = 0.005;
/// Motion of a sensor at which the push ends, rad.
const ENOUGH_RAD: f32 = 2.0 * RAD_PER_DEG;
/// Longest push, s.
const LONGEST_PUSH_S: f32 = 0.15;
/// Motion below this is noise of the Hall sensor or slack, rad.
const STILL_RAD: f32 = 0.5 * RAD_PER_DEG;

/// Angles of both sensors, rad at the paddle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    /// Angle of the encoder.
    pub encoder_rad: f32,
    /// Angle of the Hall sensor.
    pub hall_rad: f32,
}

/// The running check.
#[derive(Clone, Copy, Debug)]
pub struct WiringCheck {
    start: Angles,
    push_nm: f32,
    pushed_s: f32,
    braking: Option<Braking>,
}

/// The reversed push, which lasts as long as the push and stops the paddle.
#[derive(Clone, Copy, Debug)]
struct Braking {
    left_s: f32,
    verdict: Result<(), WiringError>,
}

/// Next action of the check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// Apply this torque, N m at the motor.
    Push(f32),
    /// The check has ended.
    Done(Result<(), WiringError>),
}

impl WiringCheck {
    /// A check of a paddle at rest at these angles. `limit_nm` limits the push, N m at the motor.
    pub fn new(start: Angles, limit_nm: f32) -> Self {
        Self {
            start,
            push_nm: PUSH_NM.min(limit_nm),
            pushed_s: 0.0,
            braking: None,
        }
    }

    /// The result, once the push has ended.
    pub fn verdict(&self) -> Option<Result<(), WiringError>> {
        self.braking.map(|braking| braking.verdict)
    }

    /// Advances the check by `elapsed_s`, s.
    pub fn advance(&mut self, elapsed_s: f32, now: Angles) -> Progress {
        match &mut self.braking {
            None => {
                let encoder_rad = now.encoder_rad - self.start.encoder_rad;
                let hall_rad = now.hall_rad - self.start.hall_rad;
                let moved = encoder_rad.abs().max(hall_rad.abs()) >= ENOUGH_RAD;
                if !moved && self.pushed_s < LONGEST_PUSH_S {
                    self.pushed_s += elapsed_s;
                    return Progress::Push(self.push_nm);
                }
                self.braking = Some(Braking {
                    left_s: self.pushed_s,
                    verdict: verdict(Turn::of(encoder_rad), Turn::of(hall_rad)),
                });
                Progress::Push(-self.push_nm)
            }
            Some(braking) => {
                braking.left_s -= elapsed_s;
                // A paddle that did not move needs no braking.
                if braking.left_s > 0.0 && braking.verdict != Err(WiringError::NothingMoves) {
                    Progress::Push(-self.push_nm)
                } else {
                    Progress::Done(braking.verdict)
                }
            }
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    Forward,
    Backward,
    Still,
}

impl Turn {
    fn of(angle_rad: f32) -> Self {
        if angle_rad > STILL_RAD {
            Self::Forward
        } else if angle_rad < -STILL_RAD {
            Self::Backward
        } else {
            Self::Still
        }
    }
}

fn verdict(encoder: Turn, hall: Turn) -> Result<(), WiringError> {
    match (encoder, hall) {
        (Turn::Forward, Turn::Forward) => Ok(()),
        (Turn::Still, Turn::Still) => Err(WiringError::NothingMoves),
        (Turn::Still, _) => Err(WiringError::EncoderStill),
        (_, Turn::Still) => Err(WiringError::HallStill),
        (Turn::Backward, Turn::Backward) => Err(WiringError::MotorReversed),
        (Turn::Backward, Turn::Forward) => Err(WiringError::EncoderReversed),
        (Turn::Forward, Turn::Backward) => Err(WiringError::HallReversed),
    }
}

/// A wiring error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WiringError {
    /// Neither sensor detected the push.
    NothingMoves,
    /// Both sensors moved in the negative direction.
    MotorReversed,
    /// The encoder counts the wrong way.
    EncoderReversed,
    /// The encoder did not move.
    EncoderStill,
    /// The Hall sensor moved in the negative direction.
    HallReversed,
    /// The Hall sensor did not move.
    HallStill,
}

impl fmt::Display for WiringError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NothingMoves => {
                "the motor does not turn the paddle: check the motor wires and the 24 V supply, let the paddle go, and \
                 move it away from its end"
            }
            Self::MotorReversed => "the motor turns backwards: swap the two motor wires",
            Self::EncoderReversed => "the encoder counts backwards: swap its wires A and B",
            Self::EncoderStill => "the encoder does not count: check its wires A, B and supply",
            Self::HallReversed => {
                "the Hall sensor goes backwards: turn its magnet, or change the sign of hall.slope"
            }
            Self::HallStill => {
                "the Hall sensor does not see the motion: check its wire, and the cable between motor and paddle"
            }
        })
    }
}

impl core::error::Error for WiringError {}
