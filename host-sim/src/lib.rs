//! Simulated haptic paddle: plant, effects, sensors and the closed loop around the control core.

pub mod device;
pub mod drive;
pub mod effects;
pub mod plant;
pub mod sensing;
