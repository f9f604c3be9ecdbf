//! The corrected model for an export.

use host_sim::device::Device;

/// A device to export.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the device, for names and comments in the file.
    pub name: String,
    /// The device with its effects, in SI units.
    pub device: Device,
    /// True for a linear axis.
    pub is_linear: bool,
}
