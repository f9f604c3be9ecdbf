//! Limits of motion and current.

use super::Fault;
use crate::settings::LimitSettings;
use crate::units::RAD_PER_DEG;

/// Limits for an armed paddle, in the units of the calculation.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    speed_rad_s: f32,
    travel_rad: f32,
    current_a: f32,
    disagreement_rad: f32,
    disagreement_ticks: u32,
}

/// Longest time for which the sensors may disagree, s. The noise of one sample causes no fault.
const DISAGREEMENT_S: f32 = 0.01;

impl Limits {
    /// The limits of these settings, for position ticks of `tick_s`.
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

    /// The first violated limit of motion. `disagreement_rad` is encoder minus Hall angle. `disagreed_ticks` counts
    /// successive ticks with a too large disagreement. The caller keeps this count.
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
