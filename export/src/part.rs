//! The parts of a device, named after the effects that cause them.

use host_sim::device::Device;
use host_sim::plant::{Cogging, Wave};

/// A part of a device other than its inertia and its ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// A limit of the input.
    Limit,
    /// A limit of the input that is rounded or falls with speed.
    Saturation,
    /// A dead band of the input.
    Deadband,
    /// A static nonlinearity of the input.
    InputNonlinearity,
    /// A limited rate of the input.
    RateLimit,
    /// Dead time of the input.
    Delay,
    /// First-order lag of the input.
    Lag,
    /// A second lag in series.
    FurtherLag,
    /// Constant torque.
    Offset,
    /// Torque ripple.
    Cogging,
    /// Ripples of further orders.
    FurtherWaves,
    /// Dry friction.
    Coulomb,
    /// Dry friction with different levels in the two directions.
    AsymmetricCoulomb,
    /// Dry friction that depends on position.
    PositionDependentCoulomb,
    /// Static friction above the sliding level.
    Stribeck,
    /// Dry friction that grows with the transmitted torque.
    LoadDependentFriction,
    /// Dry friction that changes over time.
    FrictionDrift,
    /// Viscous friction.
    Viscous,
    /// Drag with the square of the velocity.
    QuadraticDrag,
    /// Elastic presliding of the friction.
    Presliding,
    /// Gravity.
    Gravity,
    /// Spring.
    Spring,
    /// Hardening of a spring.
    Hardening,
    /// Hard stops.
    EndStop,
    /// A contact with an external object.
    Contact,
    /// Backlash.
    Backlash,
    /// A compliant transmission.
    Compliance,
    /// A gain of the sensor other than 1.
    SensorGain,
    /// A nonlinearity or an offset of the sensor.
    SensorNonlinearity,
    /// Hysteresis of the sensor.
    SensorHysteresis,
    /// A lag of the sensor.
    SensorLag,
    /// Lost counts of the sensor.
    LostCounts,
    /// A user-defined torque.
    Law,
}

impl Part {
    /// How formats whose joints have limits and one friction level approximate this part. `None` if they do not.
    pub(crate) fn by_joint_attributes(self) -> Option<&'static str> {
        match self {
            Self::EndStop => Some("limits of the joint, whose stiffness is the simulator's"),
            Self::AsymmetricCoulomb => Some("its mean"),
            _ => None,
        }
    }

    /// The effect of the vocabulary to which it belongs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "input limit",
            Self::Saturation => "saturation",
            Self::Deadband => "deadband",
            Self::InputNonlinearity => "input_nonlinearity",
            Self::RateLimit => "rate_limit",
            Self::Delay => "delay",
            Self::Lag => "lag",
            Self::FurtherLag => "second lag",
            Self::Offset => "torque_offset",
            Self::Cogging => "cogging",
            Self::FurtherWaves => "further waves of the cogging",
            Self::Coulomb => "coulomb",
            Self::AsymmetricCoulomb => "asymmetric_coulomb",
            Self::PositionDependentCoulomb => "position_dependent_coulomb",
            Self::Stribeck => "stribeck",
            Self::LoadDependentFriction => "load_dependent_friction",
            Self::FrictionDrift => "friction_drift",
            Self::Viscous => "viscous",
            Self::QuadraticDrag => "quadratic_drag",
            Self::Presliding => "presliding",
            Self::Gravity => "gravity",
            Self::Spring => "spring",
            Self::Hardening => "hardening of the spring",
            Self::EndStop => "end_stop",
            Self::Contact => "contact",
            Self::Backlash => "backlash",
            Self::Compliance => "compliance",
            Self::SensorGain => "sensor_gain",
            Self::SensorNonlinearity => "sensor_nonlinearity",
            Self::SensorHysteresis => "sensor_hysteresis",
            Self::SensorLag => "sensor_lag",
            Self::LostCounts => "lost_counts",
            Self::Law => "a torque that a user wrote down, or the dead band of a servo",
        }
    }
}

/// The parts of `device`.
pub fn parts(device: &Device) -> Vec<Part> {
    let (drive, mechanics, sensing) = (&device.drive, &device.mechanics, &device.sensing);
    let friction = &mechanics.friction;
    let [forward, backward] = friction.level_nm;
    let mut found = Vec::new();
    let mut part = |part: Part, is_there: bool| found.extend(is_there.then_some(part));
    let bends = drive.saturation.knee > 0.0 || drive.saturation.no_load_velocity.is_finite();
    part(Part::Limit, limit(device).is_finite());
    part(
        Part::Saturation,
        drive.saturation.limit.is_finite() && bends,
    );
    part(Part::Deadband, drive.deadband > 0.0);
    part(Part::InputNonlinearity, drive.curve.is_some());
    part(Part::RateLimit, drive.rate_limit.is_finite());
    part(Part::Delay, drive.delay_s > 0.0);
    part(Part::Lag, drive.lag_s > 0.0);
    part(Part::FurtherLag, drive.further_lag_s > 0.0);
    part(Part::Offset, mechanics.offset_nm != 0.0);
    part(Part::Cogging, mechanics.cogging.is_some());
    let several = |cogging: &Cogging| cogging.further[0] != Wave::NONE;
    part(
        Part::FurtherWaves,
        mechanics.cogging.as_ref().is_some_and(several),
    );
    part(Part::Coulomb, forward > 0.0 || backward > 0.0);
    part(Part::AsymmetricCoulomb, forward != backward);
    let varies = friction.position_slope != 0.0
        || friction.position_curve != 0.0
        || !friction.position_ripple.is_none()
        || !friction.position_spot.is_none();
    part(Part::PositionDependentCoulomb, varies);
    part(Part::Stribeck, !friction.stribeck.is_none());
    part(
        Part::LoadDependentFriction,
        friction.load_share != 0.0 || friction.load_backdriven_extra != 0.0,
    );
    part(Part::FrictionDrift, friction.drift.is_some());
    part(Part::Viscous, mechanics.viscous != 0.0);
    part(Part::QuadraticDrag, mechanics.drag != 0.0);
    part(Part::Presliding, mechanics.presliding.is_some());
    part(Part::Gravity, mechanics.gravity != 0.0);
    part(Part::Spring, mechanics.stiffness != 0.0);
    part(Part::Hardening, mechanics.hardening != 0.0);
    let barriers = || mechanics.barriers.iter().flatten();
    let is_stop =
        |barrier: &&host_sim::plant::Barrier| barrier.during_s.is_none() && barrier.side != 0.0;
    part(Part::EndStop, barriers().any(|barrier| is_stop(&barrier)));
    part(Part::Contact, barriers().any(|barrier| !is_stop(&barrier)));
    if let Some(link) = mechanics.link {
        part(
            if link.play > 0.0 {
                Part::Backlash
            } else {
                Part::Compliance
            },
            true,
        );
    }
    part(Part::SensorGain, sensing.gain != 1.0);
    let is_curved = sensing.quadratic != 0.0
        || sensing.cubic != 0.0
        || !sensing.ripple.is_none()
        || sensing.offset != 0.0;
    part(Part::SensorNonlinearity, is_curved);
    part(Part::SensorHysteresis, !sensing.hysteresis.is_none());
    part(Part::SensorLag, sensing.lag_s > 0.0);
    part(
        Part::LostCounts,
        !sensing.jumps.is_empty() || !sensing.overspeed.is_none(),
    );
    part(Part::Law, !mechanics.laws.is_empty());
    found
}

/// The hard limit of the input. Infinite if there is none.
pub(crate) fn limit(device: &Device) -> f64 {
    let saturation = &device.drive.saturation;
    let is_hard = saturation.knee == 0.0 && saturation.no_load_velocity.is_infinite();
    if is_hard {
        device.drive.limit.min(saturation.limit)
    } else {
        device.drive.limit
    }
}

/// The lower and the upper stop, if they exist.
pub(crate) fn stops(device: &Device) -> [Option<host_sim::plant::Barrier>; 2] {
    [-1.0, 1.0].map(|side| {
        let barriers = device.mechanics.barriers.iter().flatten();
        barriers
            .copied()
            .find(|barrier| barrier.during_s.is_none() && barrier.side == side)
    })
}
