//! A simulated haptic paddle: plant, effects, sensors, and the closed loop with the control core.

pub mod closed_loop;
pub mod decay;
pub mod device;
pub mod drive;
pub mod effects;
pub mod experiment;
pub mod hysteresis;
pub mod lab_model;
pub mod motor;
pub mod paddle;
pub mod plant;
pub mod presets;
pub mod ripple;
pub mod sensing;
pub mod sensors;
