//! What happened in one step of the paddle.

use crate::chip::Delivered;

/// A step: what acted during it, and what there was at its end, when the control interrupt begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Of its end, since power-on, s.
    pub time_s: f64,
    /// Of its end.
    pub cycle: u64,
    /// Share of the supply on the motor, -1 to 1; `None` while the bridge's outputs were off.
    pub duty: Option<f64>,
    /// True position, rad.
    pub position_rad: f64,
    /// True velocity, rad/s.
    pub velocity_rad_s: f64,
    /// Mean torque of the motor, N m.
    pub torque_nm: f64,
    /// What the program reads from the encoder's timer.
    pub encoder_count: u32,
    /// What it reads from the Hall sensor's converter.
    pub hall_counts: u16,
    /// What DMA has carried away of the current's conversions.
    pub current: Delivered,
    /// Items that are left of the current's ring: all of them, where it is in step with the control periods.
    pub ring_left: u32,
    /// What the program wrote last to the first compare register; it acts from the end of the step on.
    pub compare: u32,
}
