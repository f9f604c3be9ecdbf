//! Writes a device for common simulators, and lists what they cannot express.
//!
//! ```
//! use export::{Format, Model, exported};
//! use host_sim::device::Device;
//!
//! let nominal = recording::Model { gravity: 0.0146, coulomb: 0.015, ..recording::Model::new(5.8e-4) };
//! let model = Model { name: "paddle".into(), device: Device::nominal(&nominal), is_linear: false };
//! let exported = exported(&model, Format::Mjcf);
//! assert!(exported.text.contains("frictionloss"));
//! assert!(exported.left_out.is_empty());
//! ```

mod console;
mod exported;
mod format;
mod mjcf;
mod model;
mod part;
mod pendulum;
mod python;
mod simulink;
mod urdf;
mod usd;
mod writer;

pub use exported::{Exported, exported};
pub use format::{Format, UnknownFormat};
pub use model::Model;
pub use part::{Part, parts};
