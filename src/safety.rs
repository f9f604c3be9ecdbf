//! Faults, and the latch that keeps the first one.

use core::fmt;

use crate::settings::LimitSettings;
use crate::units::RAD_PER_DEG;

/// Why the bridge has no duty until somebody clears it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Encoder and Hall sensor disagree for too long.
    SensorDisagreement,
    /// The Hall sensor's converter is at an end of its range.
    HallSignal,
    /// The paddle turns too fast.
    Overspeed,
    /// The paddle is outside its travel.
    Travel,
    /// The motor current is too high.
    Overcurrent,
    /// A measurement or a result is not a finite number.
    NonFinite,
    /// The H-bridge reports a fault (nFAULT).
    Bridge,
    /// A control tick was missed or came too late.
    Deadline,
    /// The chip's own supply fell.
    Supply,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SensorDisagreement => {
                "encoder and Hall sensor disagree: zero again, or calibrate the Hall sensor"
            }
            Self::HallSignal => "Hall signal at the end of its range: check its wire",
            Self::Overspeed => "paddle too fast: lower the gains, or raise limit.speed",
            Self::Travel => "paddle outside its travel: bring it back, or zero again",
            Self::Overcurrent => {
                "motor current too high: look for a short circuit, or lower motor.bandwidth"
            }
            Self::NonFinite => "a number is not finite: restore the default settings",
            Self::Bridge => "H-bridge fault (nFAULT): check supply, temperature and motor wires",
            Self::Deadline => {
                "control stood still or came late: was a debugger attached? else lower the load of the processor"
            }
            Self::Supply => "the 3.3 V supply fell: check it, and what hangs on it",
        })
    }
}

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
