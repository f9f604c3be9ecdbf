//! Bounds of motion and current.

use super::Fault;
use crate::settings::LimitSettings;
use crate::units::RAD_PER_DEG;

/// Bounds that an armed paddle must keep, in the units of the arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    speed_rad_s: f32,
    travel_rad: f32,
    current_a: f32,
    disagreement_rad: f32,
    disagreement_ticks: u32,
}

/// How long the sensors may disagree; the noise of one sample is no fault.
const DISAGREEMENT_S: f32 = 0.01;

impl Limits {
    /// The bounds of these settings, at position ticks of `tick_s`.
    pub fn new(settings: &LimitSettings, tick_s: f32) -> Self {
        Self {
            speed_rad_s: settings.speed_deg_s * RAD_PER_DEG,
            travel_rad: settings.travel_deg * RAD_PER_DEG,
            current_a: settings.current_a,
            disagreement_rad: settings.disagreement_deg * RAD_PER_DEG,
            disagreement_ticks: (DISAGREEMENT_S / tick_s) as u32,
        }
    }

    /// Whether a current, A, is too high.
    #[inline]
    pub fn overcurrent(&self, current_a: f32) -> bool {
        current_a.abs() > self.current_a
    }

    /// Largest angle on either side, rad.
    pub fn travel_rad(&self) -> f32 {
        self.travel_rad
    }

    /// The first bound of motion that is not kept. `disagreement_rad` is encoder minus Hall, `disagreed_ticks` the
    /// count of ticks in a row over which that was too large, kept by the caller.
    #[inline]
    pub fn motion_fault(
        &self,
        position_rad: f32,
        velocity_rad_s: f32,
        disagreement_rad: f32,
        disagreed_ticks: &mut u32,
    ) -> Option<Fault> {
        *disagreed_ticks = if disagreement_rad.abs() > self.disagreement_rad {
            disagreed_ticks.saturating_add(1)
        } else {
            0
        };
        if position_rad.abs() > self.travel_rad {
            Some(Fault::Travel)
        } else if velocity_rad_s.abs() > self.speed_rad_s {
            Some(Fault::Overspeed)
        } else if *disagreed_ticks > self.disagreement_ticks {
            Some(Fault::SensorDisagreement)
        } else {
            None
        }
    }
}
