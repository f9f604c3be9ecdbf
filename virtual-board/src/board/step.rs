//! The record of one paddle step.

use crate::chip::Delivered;

/// One paddle step: the inputs during the step, and the state at its end, when the control interrupt begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Time of its end since power-on, s.
    pub time_s: f64,
    /// Core cycle of its end.
    pub cycle: u64,
    /// Duty cycle of the bridge, -1 to 1. `None` while its outputs were off.
    pub duty: Option<f64>,
    /// True position, rad.
    pub position_rad: f64,
    /// True velocity, rad/s.
    pub velocity_rad_s: f64,
    /// Mean torque of the motor, N m.
    pub torque_nm: f64,
    /// Count that the firmware reads from the encoder timer.
    pub encoder_count: u32,
    /// Result that the firmware reads from the Hall sensor's converter, counts.
    pub hall_counts: u16,
    /// Current conversions that DMA has transferred.
    pub current: Delivered,
    /// Remaining items of the current's DMA ring. It is the full number if the ring is aligned with the control periods.
    pub ring_left: u32,
    /// Last value written to the first compare register. It acts from the end of the step.
    pub compare: u32,
}
