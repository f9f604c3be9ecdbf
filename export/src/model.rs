//! The corrected model that an export writes.

use host_sim::device::Device;

/// A device to be written for a simulator.
#[derive(Clone, Debug)]
pub struct Model {
    /// Title of the device, for names and comments.
    pub name: String,
    /// The device with its effects, in SI units.
    pub device: Device,
    /// It slides rather than turns.
    pub is_linear: bool,
}
