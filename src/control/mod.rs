//! Control: from the estimate and the setpoint to a torque, and from the torque to a duty.

pub mod anti_windup;
pub mod compensation;
pub mod current;
pub mod position;
