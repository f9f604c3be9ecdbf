//! Calibration of the Hall sensor against the encoder. The paddle moves slowly from end to end and back. A cubic is fitted
//! to the sensor's voltage at each angle.

use core::fmt;

use super::fit::least_squares;
use super::{Finding, Outcome, ProcedureError};
use crate::console::Device;
use crate::decimal::Fixed;
use crate::scalar::limit;
use crate::sensing::hall;
use crate::settings::{DerivativeSource, HallSettings, Settings};
use crate::units::{DEG_PER_RAD, RAD_PER_DEG};

/// Largest angle on either side, rad. It is less if limit.travel is less. The mechanical travel is 35 degrees.
const REACH_RAD: f32 = 33.0 * RAD_PER_DEG;
/// Margin to limit.travel, rad.
const BEFORE_LIMIT_RAD: f32 = 5.0 * RAD_PER_DEG;
/// Speed of the setpoint, rad/s.
const SPEED_RAD_S: f32 = 8.0 * RAD_PER_DEG;
/// Lag behind the setpoint that counts as an obstacle, rad.
const BEHIND_RAD: f32 = 3.0 * RAD_PER_DEG;
/// Duration of this lag that counts as an obstacle, s.
const BEHIND_S: f32 = 0.2;
/// Least angle that must be reached on each side, rad.
const LEAST_REACH_RAD: f32 = 15.0 * RAD_PER_DEG;
/// Number of equal parts of the way over which means are taken.
const PARTS: usize = 48;
/// Least span of the sensor's voltage, V. A smaller span is noise.
const LEAST_SPAN_V: f32 = 0.1;

/// Changes the settings for the position loop: the report's gains of row "encoder 4", independent of the Hall sensor.
pub fn adapt(settings: &mut Settings) {
    let pid = &mut settings.pid;
    pid.kp_nm_per_deg = 0.05;
    pid.ki_nm_per_deg_s = 0.28;
    pid.kd_nm_s_per_deg = 0.0008;
    pid.setpoint_weight = 1.0;
    pid.derivative = DerivativeSource::Position;
    settings.limit.speed_deg_s = settings.limit.speed_deg_s.min(300.0);
    // This is above the allowed range of the setting, because an uncalibrated sensor can disagree by any amount.
    settings.limit.disagreement_deg = 1_000.0;
}

/// The result of the procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HallFinding {
    /// The calibration curve.
    pub curve: HallSettings,
    /// Lowest measured angle, rad.
    pub from_rad: f32,
    /// Highest measured angle, rad.
    pub to_rad: f32,
    /// Largest difference between curve and encoder, rad.
    pub worst_rad: f32,
}

impl fmt::Display for HallFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the Hall sensor from {} to {} deg: {} deg/V at {} V, off by {} deg at most\r\n\
             hall.centre, slope, quadratic and cubic are set; save stores them",
            Fixed(self.from_rad * DEG_PER_RAD, 1),
            Fixed(self.to_rad * DEG_PER_RAD, 1),
            Fixed(self.curve.slope_deg_per_v, 2),
            Fixed(self.curve.centre_v, 4),
            Fixed(self.worst_rad * DEG_PER_RAD, 3)
        )
    }
}

/// The running procedure.
#[derive(Clone, Debug)]
pub struct HallCalibration {
    reach_rad: f32,
    setpoint_rad: Option<f32>,
    leg: usize,
    behind_s: f32,
    /// Angles that were reached at the two ends, rad.
    ends_rad: [f32; 2],
    parts: [Part; PARTS],
}

/// Sums over one part of the way.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    count: f32,
    angle_rad: f32,
    volts: f32,
}

impl HallCalibration {
    /// Starts the procedure with the user's settings.
    pub fn new(users: &Settings) -> Self {
        let limit_rad = users.limit.travel_deg * RAD_PER_DEG - BEFORE_LIMIT_RAD;
        Self {
            reach_rad: REACH_RAD.min(limit_rad),
            setpoint_rad: None,
            leg: 0,
            behind_s: 0.0,
            ends_rad: [0.0; 2],
            parts: [Part::default(); PARTS],
        }
    }

    /// See [`super::Procedure::advance`].
    #[inline(never)]
    pub fn advance(&mut self, elapsed_s: f32, device: &mut impl Device) -> Option<Outcome> {
        let (position_rad, adc) = device.with(|c| (c.encoder_rad(), c.hall_adc()));
        let setpoint_rad = *self.setpoint_rad.get_or_insert(position_rad);
        // The paddle moves up, down, and up to the middle again, so that each angle is passed in both directions.
        let target_rad = match self.leg {
            0 => self.reach_rad,
            1 => -self.reach_rad,
            2 => 0.0,
            _ => return Some(self.conclude().map(Finding::Hall)),
        };
        self.add(position_rad, hall::volts(adc));
        let behind = (setpoint_rad - position_rad).abs() > BEHIND_RAD;
        self.behind_s = if behind {
            self.behind_s + elapsed_s
        } else {
            0.0
        };
        let met = self.behind_s > BEHIND_S;
        let step_rad = SPEED_RAD_S * elapsed_s;
        let left_rad = target_rad - setpoint_rad;
        let next_rad = if met {
            position_rad
        } else {
            setpoint_rad + limit(left_rad, step_rad)
        };
        if met || left_rad.abs() <= step_rad {
            if let Some(end_rad) = self.ends_rad.get_mut(self.leg) {
                *end_rad = position_rad;
                if position_rad.abs() < LEAST_REACH_RAD {
                    return Some(Err(ProcedureError::Blocked {
                        angle_rad: position_rad,
                    }));
                }
            }
            self.leg += 1;
            self.behind_s = 0.0;
        }
        self.setpoint_rad = Some(next_rad);
        // The reference is refused only after a fault, which the console reports.
        let _ = device.with(|c| c.set_reference(next_rad));
        None
    }

    fn add(&mut self, angle_rad: f32, volts: f32) {
        let share = 0.5 + 0.5 * angle_rad / self.reach_rad;
        if (0.0..1.0).contains(&share)
            && let Some(part) = self.parts.get_mut((share * PARTS as f32) as usize)
        {
            part.count += 1.0;
            part.angle_rad += angle_rad;
            part.volts += volts;
        }
    }

    fn conclude(&self) -> Result<HallFinding, ProcedureError> {
        let [to_rad, from_rad] = self.ends_rad;
        let mut low_v = f32::INFINITY;
        let mut high_v = f32::NEG_INFINITY;
        for part in self.parts.iter().filter(|part| part.count > 0.0) {
            let volts = part.volts / part.count;
            low_v = low_v.min(volts);
            high_v = high_v.max(volts);
        }
        let (middle_v, half_v) = (0.5 * (low_v + high_v), 0.5 * (high_v - low_v));
        if half_v.is_nan() || 2.0 * half_v < LEAST_SPAN_V {
            return Err(ProcedureError::NoHallSignal);
        }
        // A part without measurements has no weight.
        let weight = self
            .parts
            .map(|part| if part.count > 0.0 { 1.0 } else { 0.0 });
        let of = |values: fn(&Part) -> f32| {
            self.parts.map(|part| {
                if part.count > 0.0 {
                    values(&part) / part.count
                } else {
                    0.0
                }
            })
        };
        let angle_deg = of(|part| part.angle_rad * DEG_PER_RAD);
        let volts = of(|part| part.volts);
        let at: [f32; PARTS] = core::array::from_fn(|part| {
            let (volts, weight) = (volts.get(part), weight.get(part));
            (volts.unwrap_or(&0.0) - middle_v) / half_v * weight.unwrap_or(&0.0)
        });
        let square = at.map(|x| x * x);
        let cube = at.map(|x| x * x * x);
        let [constant, linear, quadratic, cubic] =
            least_squares([weight, at, square, cube], angle_deg)
                .ok_or(ProcedureError::NoHallSignal)?;
        let curve = Cubic([constant, linear, quadratic, cubic]);
        if !curve.is_monotonic() {
            return Err(ProcedureError::NotMonotonic);
        }
        let worst_deg = (0..PARTS)
            .filter_map(|part| Some((*at.get(part)?, *angle_deg.get(part)?, *weight.get(part)?)))
            .filter(|(_, _, weight)| *weight > 0.0)
            .map(|(at, angle_deg, _)| (curve.at(at) - angle_deg).abs())
            .fold(0.0, f32::max);
        let centre = curve.zero();
        let [slope, quadratic, cubic] = curve.about(centre);
        Ok(HallFinding {
            curve: HallSettings {
                centre_v: middle_v + half_v * centre,
                slope_deg_per_v: slope / half_v,
                quadratic_deg_per_v2: quadratic / (half_v * half_v),
                cubic_deg_per_v3: cubic / (half_v * half_v * half_v),
            },
            from_rad,
            to_rad,
            worst_rad: worst_deg * RAD_PER_DEG,
        })
    }
}

/// Angle in degrees as a cubic of the voltage scaled to -1 to 1. Coefficients start with the constant one.
struct Cubic([f32; 4]);

impl Cubic {
    fn at(&self, x: f32) -> f32 {
        let [constant, linear, quadratic, cubic] = self.0;
        constant + x * (linear + x * (quadratic + x * cubic))
    }

    fn slope(&self, x: f32) -> f32 {
        let [_, linear, quadratic, cubic] = self.0;
        linear + x * (2.0 * quadratic + x * 3.0 * cubic)
    }

    /// Returns true if the slope keeps its sign over the span and a little beyond.
    fn is_monotonic(&self) -> bool {
        const BEYOND: f32 = 1.05;
        const LOOKS: i32 = 64;
        let first = self.slope(-BEYOND);
        (0..=LOOKS).all(|look| {
            let x = BEYOND * (2.0 * look as f32 / LOOKS as f32 - 1.0);
            self.slope(x) * first > 0.0
        })
    }

    /// Scaled voltage at which the angle is 0, by bisection. The curve is monotonic, and the angle changes sign within the
    /// span.
    fn zero(&self) -> f32 {
        const HALVINGS: u32 = 24;
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (self.at(middle) > 0.0) == (self.at(high) > 0.0) {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Coefficients of the cubic around `x`, starting with the linear one.
    fn about(&self, x: f32) -> [f32; 3] {
        let [_, _, quadratic, cubic] = self.0;
        [self.slope(x), quadratic + 3.0 * cubic * x, cubic]
    }
}
