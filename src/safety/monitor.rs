//! Supervision over windows of a millisecond: a current that does not match the voltage, heat, a stall, and an encoder that
//! does not count while the paddle moves.

use super::Fault;
use crate::control::current::MAX_DUTY;
use crate::settings::Settings;
use crate::units::RAD_PER_DEG;

/// Length of a window, s. Over this time the inductance of the winding hardly matters, and one encoder count corresponds to
/// 0.2 V of back-EMF.
const WINDOW_S: f32 = 1e-3;

/// Number of successive windows with a voltage mismatch that is a fault.
const MISMATCHED_WINDOWS: u32 = 2;

/// Continuous current of the motor, A: its rated torque of 32.3 mN m over 53.8 mN m/A.
const MOTOR_RATED_A: f32 = 0.6;
/// Thermal time constant of the winding, s. Motors of this size have 10 s or more.
const MOTOR_THERMAL_S: f32 = 10.0;
/// Continuous current of the bridge, A. It is below that of any driver for this motor.
const BRIDGE_RATED_A: f32 = 1.0;
/// Thermal time constant of the bridge, s.
const BRIDGE_THERMAL_S: f32 = 0.2;
/// Heat that is a fault, relative to that at the continuous current.
const TOO_HOT: f32 = 1.1;

/// Share of the torque limit that counts as full torque.
const STALL_SHARE: f32 = 0.9;
/// Motion below this counts as no motion, rad.
const STALLED_RAD: f32 = 0.5 * RAD_PER_DEG;

/// Motion of the encoder, rad, that proves that it counts.
const ENCODER_STILL_RAD: f32 = 0.25 * RAD_PER_DEG;
/// Motion of the Hall sensor, rad, at which the encoder must have moved. It is larger than the sensor's worst calibration
/// error and noise.
const HALL_MOVED_RAD: f32 = 2.5 * RAD_PER_DEG;
/// Motion of the Hall sensor above its noise, rad.
const HALL_MOVING_RAD: f32 = RAD_PER_DEG;
/// Number of successive windows in which the encoder must be still. From rest at full torque, a fault is found after 13 ms
/// and 4 degrees.
const STILL_WINDOWS: u32 = 3;

/// Number of ticks after the end of a window over which its evaluation is distributed.
const STAGES: u32 = 5;

/// Parameters of the monitor for one rate.
#[derive(Clone, Copy, Debug)]
pub struct MonitorGains {
    ticks: u32,
    per_ticks: f32,
    supply_v: f32,
    mismatch_v: f32,
    resistance_ohm: f32,
    /// Back-EMF of a window per rad of paddle motion, V.
    emf_v_per_rad: f32,
    motor_share: f32,
    bridge_share: f32,
    torque_limit_nm: f32,
    full_torque_nm: f32,
    /// Sum of the duties of a window at their limit.
    full_duty: f32,
    stall_windows: u32,
}

impl MonitorGains {
    /// The parameters for samples every `tick_s`, s.
    pub fn new(settings: &Settings, tick_s: f32) -> Self {
        let ticks = ((WINDOW_S / tick_s) as u32).max(STAGES + 1);
        let window_s = ticks as f32 * tick_s;
        let motor = &settings.motor;
        Self {
            ticks,
            per_ticks: 1.0 / ticks as f32,
            supply_v: motor.supply_v,
            mismatch_v: settings.limit.mismatch_v,
            resistance_ohm: motor.resistance_ohm,
            emf_v_per_rad: motor.torque_constant_nm_per_a * settings.mechanism.ratio / window_s,
            motor_share: window_s / MOTOR_THERMAL_S,
            bridge_share: window_s / BRIDGE_THERMAL_S,
            torque_limit_nm: motor.torque_limit_nm,
            full_duty: (ticks as f32 - 0.5) * MAX_DUTY,
            full_torque_nm: STALL_SHARE * motor.torque_limit_nm,
            stall_windows: if settings.limit.stall_s > 0.0 {
                (settings.limit.stall_s / window_s) as u32
            } else {
                u32::MAX
            },
        }
    }
}

/// Supervises motor, bridge and encoder.
#[derive(Clone, Copy, Debug)]
pub struct Monitor {
    gains: MonitorGains,
    ticks: u32,
    duty: f32,
    current_a: f32,
    /// Mean current of the last window, A.
    /// Mean voltage that drove this current, V: the duty times the supply, minus the back-EMF.
    mean_a: f32,
    driving_v: f32,
    started_rad: f32,
    mismatched: u32,
    motor_heat: f32,
    bridge_heat: f32,
    stalled: u32,
    stalled_at_rad: f32,
    encoder_mark_rad: f32,
    hall_mark_rad: f32,
    /// Motion of the Hall sensor since the encoder last moved, rad.
    apart_rad: f32,
    still: u32,
    encoder_ignored: bool,
    /// Number of windows in which the torque was limited.
    torque_limited: u32,
    /// Number of windows in which the duty was limited all the time.
    duty_limited: u32,
    /// Sum of voltage times current, V A.
    volt_amperes: f32,
    /// Sum of current squared, A^2.
    amperes2: f32,
}

impl Monitor {
    /// A monitor for a cold motor.
    pub fn new(gains: MonitorGains) -> Self {
        Self {
            gains,
            ticks: 0,
            duty: 0.0,
            current_a: 0.0,
            mean_a: 0.0,
            driving_v: 0.0,
            started_rad: 0.0,
            mismatched: 0,
            motor_heat: 0.0,
            bridge_heat: 0.0,
            stalled: 0,
            stalled_at_rad: 0.0,
            encoder_mark_rad: 0.0,
            hall_mark_rad: 0.0,
            apart_rad: 0.0,
            still: 0,
            encoder_ignored: false,
            torque_limited: 0,
            duty_limited: 0,
            volt_amperes: 0.0,
            amperes2: 0.0,
        }
    }

    /// Changes the parameters.
    pub fn retune(&mut self, gains: MonitorGains) {
        self.gains = gains;
    }

    /// Restarts the monitor at the present position. The heat is kept.
    pub fn restart(&mut self, encoder_rad: f32, hall_rad: f32) {
        *self = Self {
            motor_heat: self.motor_heat,
            bridge_heat: self.bridge_heat,
            torque_limited: self.torque_limited,
            duty_limited: self.duty_limited,
            started_rad: encoder_rad,
            stalled_at_rad: encoder_rad,
            encoder_mark_rad: encoder_rad,
            hall_mark_rad: hall_rad,
            ..Self::new(self.gains)
        };
    }

    /// Ignores a still encoder until the next restart. The wiring check detects it by itself and brakes the paddle.
    pub fn ignore_encoder(&mut self) {
        self.encoder_ignored = true;
    }

    /// Adds the duty, -1 to 1, and the current, A, of one tick. Returns true if [`Self::judge`] must be called in this tick.
    #[inline]
    pub fn add(&mut self, duty: f32, current_a: f32) -> bool {
        self.duty += duty;
        self.current_a += current_a;
        self.ticks += 1;
        self.ticks <= STAGES || self.ticks == self.gains.ticks
    }

    /// Models the cooling of motor and bridge without current, by one tick.
    #[inline]
    pub fn cool(&mut self) {
        self.ticks += 1;
        if self.ticks >= self.gains.ticks {
            self.ticks = 0;
            self.mean_a = 0.0;
            self.heats_motor();
            self.heats_bridge();
        }
    }

    /// Evaluates the window, in a tick for which [`Self::add`] returned true. Inputs are the commanded torque, N m at the
    /// motor, the positions of encoder and Hall sensor, rad, and whether the Hall signal is plausible. Returns a fault.
    #[inline]
    pub fn judge(
        &mut self,
        torque_nm: f32,
        encoder_rad: f32,
        hall_rad: f32,
        hall_plausible: bool,
    ) -> Option<Fault> {
        match self.ticks {
            1 => self.mismatches(),
            2 => self.heats_motor().then_some(Fault::MotorHeat),
            3 => self.heats_bridge().then_some(Fault::BridgeHeat),
            4 => {
                let still = self.encoder_is_still(encoder_rad, hall_rad, hall_plausible);
                still.then_some(Fault::EncoderStill)
            }
            STAGES => self.stalls(torque_nm, encoder_rad).then_some(Fault::Stall),
            _ => {
                self.close(encoder_rad);
                None
            }
        }
    }

    /// Ends the window.
    #[inline]
    fn close(&mut self, encoder_rad: f32) {
        let gains = &self.gains;
        if self.duty.abs() >= gains.full_duty {
            self.duty_limited = self.duty_limited.wrapping_add(1);
        }
        let moved_rad = encoder_rad - self.started_rad;
        self.driving_v =
            self.duty * gains.per_ticks * gains.supply_v - gains.emf_v_per_rad * moved_rad;
        self.mean_a = self.current_a * gains.per_ticks;
        self.ticks = 0;
        self.duty = 0.0;
        self.current_a = 0.0;
        self.started_rad = encoder_rad;
    }

    /// Compares the mean current of the last window with the driving voltage and the winding resistance.
    #[inline]
    fn mismatches(&mut self) -> Option<Fault> {
        self.volt_amperes += self.driving_v * self.mean_a;
        self.amperes2 += self.mean_a * self.mean_a;
        let mismatch_v = self.driving_v - self.gains.resistance_ohm * self.mean_a;
        self.mismatched = if mismatch_v.abs() > self.gains.mismatch_v {
            self.mismatched + 1
        } else {
            0
        };
        // With a still encoder, the back-EMF is missing in the model. The encoder is then the cause of the mismatch.
        (self.mismatched >= MISMATCHED_WINDOWS).then_some(if self.apart_rad > HALL_MOVING_RAD {
            Fault::EncoderStill
        } else {
            Fault::CurrentMismatch
        })
    }

    /// Updates the heat of the motor with the mean current of the last window. Returns true if it is too hot.
    #[inline]
    fn heats_motor(&mut self) -> bool {
        const PER_RATED2: f32 = 1.0 / (MOTOR_RATED_A * MOTOR_RATED_A);
        let heat = self.mean_a * self.mean_a * PER_RATED2;
        self.motor_heat += (heat - self.motor_heat) * self.gains.motor_share;
        self.motor_heat > TOO_HOT
    }

    /// Updates the heat of the bridge. Returns true if it is too hot.
    #[inline]
    fn heats_bridge(&mut self) -> bool {
        const PER_RATED2: f32 = 1.0 / (BRIDGE_RATED_A * BRIDGE_RATED_A);
        let heat = self.mean_a * self.mean_a * PER_RATED2;
        self.bridge_heat += (heat - self.bridge_heat) * self.gains.bridge_share;
        self.bridge_heat > TOO_HOT
    }

    #[inline]
    fn stalls(&mut self, torque_nm: f32, encoder_rad: f32) -> bool {
        let full_nm = self.gains.full_torque_nm;
        if torque_nm.abs() >= self.gains.torque_limit_nm {
            self.torque_limited = self.torque_limited.wrapping_add(1);
        }
        let pushes = torque_nm.abs() >= full_nm && full_nm > 0.0;
        if !pushes || (encoder_rad - self.stalled_at_rad).abs() > STALLED_RAD {
            self.stalled = 0;
            self.stalled_at_rad = encoder_rad;
        } else {
            self.stalled += 1;
        }
        self.stalled >= self.gains.stall_windows
    }

    #[inline]
    fn encoder_is_still(&mut self, encoder_rad: f32, hall_rad: f32, hall_plausible: bool) -> bool {
        if (encoder_rad - self.encoder_mark_rad).abs() > ENCODER_STILL_RAD || !hall_plausible {
            self.encoder_mark_rad = encoder_rad;
            self.hall_mark_rad = hall_rad;
        }
        self.apart_rad = (hall_rad - self.hall_mark_rad).abs();
        self.still = if self.apart_rad > HALL_MOVED_RAD && !self.encoder_ignored {
            self.still + 1
        } else {
            0
        };
        self.still >= STILL_WINDOWS
    }

    /// Number of windows in which the torque was limited at the end, and number in which the duty was limited all the time.
    pub fn limited(&self) -> (u32, u32) {
        (self.torque_limited, self.duty_limited)
    }

    /// Winding resistance, ohm, by least squares over all windows since the last restart: voltage minus back-EMF, over
    /// current. `None` if the current was too small.
    pub fn resistance_ohm(&self) -> Option<f32> {
        /// Sum over a fiftieth of a second with half the current of the wiring check, A^2.
        const ENOUGH_A2: f32 = 20.0 * 0.045 * 0.045;
        (self.amperes2 > ENOUGH_A2).then(|| self.volt_amperes / self.amperes2)
    }
}
