//! What shows over a millisecond and not in a single sample: a current that does not follow the voltage, heat, a stall,
//! and an encoder that stands still while the paddle moves.

use super::Fault;
use crate::control::current::MAX_DUTY;
use crate::settings::Settings;
use crate::units::RAD_PER_DEG;

/// Length of a window, s: over it the winding's inductance hardly shows, and a count of the encoder is 0.2 V of the
/// motor's own voltage.
const WINDOW_S: f32 = 1e-3;

/// Windows in a row in which voltage and current differ by more than they may.
const MISMATCHED_WINDOWS: u32 = 2;

/// Current that the motor bears for ever, A: its rated torque of 32.3 mN m over 53.8 mN m/A.
const MOTOR_RATED_A: f32 = 0.6;
/// Time constant of its winding, s; motors of this size have 10 s or more.
const MOTOR_THERMAL_S: f32 = 10.0;
/// Current that the bridge bears for ever, A, and its time constant, s: below what any driver for this motor bears.
const BRIDGE_RATED_A: f32 = 1.0;
const BRIDGE_THERMAL_S: f32 = 0.2;
/// Heat, as a share of that at the rated current, that is too much.
const TOO_HOT: f32 = 1.1;

/// Share of the torque limit that counts as all of it, and the motion, rad, that is none.
const STALL_SHARE: f32 = 0.9;
const STALLED_RAD: f32 = 0.5 * RAD_PER_DEG;

/// An encoder that counts has moved by more than this, rad, long before
const ENCODER_STILL_RAD: f32 = 0.25 * RAD_PER_DEG;
/// the Hall sensor, at its worst calibration and noise, has by this, rad,
const HALL_MOVED_RAD: f32 = 2.5 * RAD_PER_DEG;
/// (by this, rad, it moves, beyond its noise)
const HALL_MOVING_RAD: f32 = RAD_PER_DEG;
/// for so many windows in a row. From rest at full torque that takes 13 ms and 4 degrees.
const STILL_WINDOWS: u32 = 3;

/// Ticks after the end of a window that share the work on it.
const STAGES: u32 = 5;

/// What the monitor goes by, for one rate.
#[derive(Clone, Copy, Debug)]
pub struct MonitorGains {
    ticks: u32,
    per_ticks: f32,
    supply_v: f32,
    mismatch_v: f32,
    resistance_ohm: f32,
    /// The motor's own voltage, V, for each rad of the paddle in a window.
    emf_v_per_rad: f32,
    motor_share: f32,
    bridge_share: f32,
    torque_limit_nm: f32,
    full_torque_nm: f32,
    /// Sum of a window's duties at their limit.
    full_duty: f32,
    stall_windows: u32,
}

impl MonitorGains {
    /// For samples every `tick_s`, s.
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

/// The monitor.
#[derive(Clone, Copy, Debug)]
pub struct Monitor {
    gains: MonitorGains,
    ticks: u32,
    duty: f32,
    current_a: f32,
    /// Mean current of the last window, A, and the mean voltage that drove it, V.
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
    /// By how much the Hall sensor has moved while the encoder has not, rad.
    apart_rad: f32,
    still: u32,
    encoder_ignored: bool,
    /// Milliseconds at the limits of torque and of duty.
    torque_limited: u32,
    duty_limited: u32,
    /// Sums of voltage times current and of current squared, V A and A^2.
    volt_amperes: f32,
    amperes2: f32,
}

impl Monitor {
    /// A monitor of a cold motor.
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

    /// Takes over gains.
    pub fn retune(&mut self, gains: MonitorGains) {
        self.gains = gains;
    }

    /// Begins anew where the paddle stands; the heat stays.
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

    /// Lets an encoder stand still until the next restart: the wiring check finds that out by itself, and brakes.
    pub fn ignore_encoder(&mut self) {
        self.encoder_ignored = true;
    }

    /// Takes a tick's duty, -1 to 1, and current, A. The ticks of a window share its work, which is [`Self::judge`]'s.
    #[inline]
    pub fn add(&mut self, duty: f32, current_a: f32) -> bool {
        self.duty += duty;
        self.current_a += current_a;
        self.ticks += 1;
        self.ticks <= STAGES || self.ticks == self.gains.ticks
    }

    /// Lets motor and bridge cool while they carry no current, by a tick.
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

    /// What is wrong, at a tick for which [`Self::add`] asks: with the torque wanted, N m at the motor, the positions by
    /// encoder and Hall sensor, rad, and whether the latter's signal says anything.
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

    /// Whether the current of the last window is what the motor makes of the voltage.
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
        // With an encoder that stands still the motor's own voltage is missing from the model: then that is the cause.
        (self.mismatched >= MISMATCHED_WINDOWS).then_some(if self.apart_rad > HALL_MOVING_RAD {
            Fault::EncoderStill
        } else {
            Fault::CurrentMismatch
        })
    }

    /// Heats the motor by the mean current of the last window, and lets it cool. Whether it is too hot.
    #[inline]
    fn heats_motor(&mut self) -> bool {
        const PER_RATED2: f32 = 1.0 / (MOTOR_RATED_A * MOTOR_RATED_A);
        let heat = self.mean_a * self.mean_a * PER_RATED2;
        self.motor_heat += (heat - self.motor_heat) * self.gains.motor_share;
        self.motor_heat > TOO_HOT
    }

    /// The same of the bridge.
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

    /// Milliseconds so far at whose end the torque was limited, and in which the duty was all the time.
    pub fn limited(&self) -> (u32, u32) {
        (self.torque_limited, self.duty_limited)
    }

    /// Resistance of the winding, ohm, by least squares over all windows since the last restart: voltage less the
    /// motor's own, over current. `None` if there was too little current to tell.
    pub fn resistance_ohm(&self) -> Option<f32> {
        /// Sum over a fiftieth of a second of half the wiring check's current, A^2.
        const ENOUGH_A2: f32 = 20.0 * 0.045 * 0.045;
        (self.amperes2 > ENOUGH_A2).then(|| self.volt_amperes / self.amperes2)
    }
}
