//! Settings converted for one rate.

use idsp::iir::Biquad;

use crate::control::compensation::Compensation;
use crate::control::current::CurrentGains;
use crate::control::position::PidGains;
use crate::estimate::position_filter;
use crate::estimate::velocity::ObserverGains;
use crate::safety::{Limits, MonitorGains};
use crate::sensing::encoder;
use crate::sensing::hall::HallCurve;
use crate::settings::{Sensor, Settings};
use crate::units::RAD_PER_DEG;

/// Rate of calls of [`Controller::step`](super::Controller::step), and number of calls per position tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickRate {
    tick_hz: f32,
    pub(super) divider: u16,
}

impl TickRate {
    /// `tick_hz` calls of `step` per second. The position loop runs at every `divider`-th call (0 counts as 1).
    pub const fn new(tick_hz: f32, divider: u16) -> Self {
        Self {
            tick_hz,
            divider: if divider == 0 { 1 } else { divider },
        }
    }

    /// Period of the current loop, s.
    pub fn tick_s(&self) -> f32 {
        1.0 / self.tick_hz
    }

    /// Period of the position loop, s.
    pub fn position_tick_s(&self) -> f32 {
        f32::from(self.divider) / self.tick_hz
    }
}

/// Settings converted for one rate. All divisions and exponentials are computed here, outside the control interrupt.
#[derive(Clone, Debug)]
pub struct Tuning {
    pub(super) rad_per_count: f32,
    pub(super) hall: HallCurve,
    pub(super) sensor: Sensor,
    pub(super) filter: Biquad<f32>,
    pub(super) velocity: ObserverGains,
    pub(super) acceleration_per_nm: f32,
    pub(super) pid: PidGains,
    pub(super) compensation: Compensation,
    pub(super) current: CurrentGains,
    pub(super) limits: Limits,
    pub(super) monitor: MonitorGains,
    pub(super) torque_limit_nm: f32,
    pub(super) band_rad: f32,
}

impl Tuning {
    /// Converts these settings for this rate.
    pub fn new(settings: &Settings, rate: TickRate) -> Self {
        let tick_s = rate.position_tick_s();
        let ratio = settings.mechanism.ratio;
        let estimate = &settings.estimate;
        let pid = PidGains::new(&settings.pid, ratio, settings.motor.torque_limit_nm, tick_s);
        Self {
            rad_per_count: encoder::rad_per_count(settings.mechanism.counts_per_turn, ratio),
            hall: HallCurve::new(&settings.hall),
            sensor: estimate.sensor,
            filter: position_filter::section(estimate, tick_s),
            velocity: ObserverGains::new(estimate.velocity_bandwidth_hz, tick_s),
            acceleration_per_nm: ratio / settings.mechanism.inertia_kg_m2,
            pid: if settings.pid.derivative.is_observer(estimate.sensor) {
                pid.observed(tick_s)
            } else {
                pid
            },
            compensation: Compensation::new(&settings.compensation, ratio),
            current: CurrentGains::new(&settings.motor, ratio, rate.tick_s()),
            limits: Limits::new(&settings.limit, tick_s),
            monitor: MonitorGains::new(settings, tick_s),
            torque_limit_nm: settings.motor.torque_limit_nm,
            band_rad: settings.metrics.band_deg * RAD_PER_DEG,
        }
    }
}
