//! Simulated haptic paddle: plant, effects, sensors and the closed loop around the control core.

pub mod drive;
pub mod plant;
