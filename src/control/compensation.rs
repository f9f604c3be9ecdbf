//! Compensation torques for dry friction, viscous friction and gravity.

use crate::phase::Phase;
use crate::scalar::limit;
use crate::settings::{CompensationSettings, VelocitySource};
use crate::units::RAD_PER_DEG;

/// The compensations of one mechanism, as torques at the motor. A compensation that is switched off has the level 0.
#[derive(Clone, Copy, Debug)]
pub struct Compensation {
    any: bool,
    dry_forward_nm: f32,
    dry_backward_nm: f32,
    per_dry_band_s_rad: f32,
    dry_source: VelocitySource,
    viscous_nm_s_rad: f32,
    gravity_nm: f32,
    gravity_zero_rad: f32,
}

impl Compensation {
    /// Prepares the compensations. `ratio` is the number of motor turns per paddle turn.
    pub fn new(settings: &CompensationSettings, ratio: f32) -> Self {
        let when = |on: bool, level: f32| if on { level } else { 0.0 };
        Self {
            any: settings.dry || settings.viscous || settings.gravity,
            dry_forward_nm: when(settings.dry, settings.dry_forward_nm),
            dry_backward_nm: when(settings.dry, settings.dry_backward_nm),
            per_dry_band_s_rad: 1.0 / (settings.dry_band_deg_s * RAD_PER_DEG),
            dry_source: settings.dry_source,
            viscous_nm_s_rad: when(settings.viscous, settings.viscous_nm_s_per_rad / ratio),
            gravity_nm: when(settings.gravity, settings.gravity_nm / ratio),
            gravity_zero_rad: settings.gravity_zero_deg * RAD_PER_DEG,
        }
    }

    /// Compensation torque at the motor, N m.
    ///
    /// Dry friction has a level for each direction. It changes linearly within the low-velocity band, because a sign
    /// function would chatter at rest. Gravity is m g l sin(angle - zero), where zero is the hanging position.
    #[inline]
    pub fn torque_nm(
        &self,
        position_rad: f32,
        velocity_rad_s: f32,
        setpoint_velocity_rad_s: f32,
    ) -> f32 {
        if !self.any {
            return 0.0;
        }
        let dry_velocity = match self.dry_source {
            VelocitySource::Measured => velocity_rad_s,
            VelocitySource::Setpoint => setpoint_velocity_rad_s,
        };
        let level = if dry_velocity > 0.0 {
            self.dry_forward_nm
        } else {
            self.dry_backward_nm
        };
        let mut torque_nm = level * limit(dry_velocity * self.per_dry_band_s_rad, 1.0);
        torque_nm += self.viscous_nm_s_rad * velocity_rad_s;
        if self.gravity_nm != 0.0 {
            torque_nm +=
                self.gravity_nm * Phase::from_rad(position_rad - self.gravity_zero_rad).sin();
        }
        torque_nm
    }
}
