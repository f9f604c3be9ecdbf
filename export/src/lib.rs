//! Writes a device for the simulators that people use, and names what these cannot express.
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
mod mjcf;
mod part;
mod pendulum;
mod python;
mod simulink;
mod urdf;
mod usd;

pub use part::{Part, parts};

use host_sim::device::Device;

/// A device to be written for a simulator.
#[derive(Clone, Debug)]
pub struct Model {
    /// Of the device, for names and comments.
    pub name: String,
    /// The device with its effects, in SI units.
    pub device: Device,
    /// It slides rather than turns.
    pub is_linear: bool,
}

/// For which simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MuJoCo's XML.
    Mjcf,
    /// ROS's robot description.
    Urdf,
    /// Universal Scene Description with UsdPhysics and PhysX's joint attributes.
    Usd,
    /// A MATLAB function for a block of Simulink.
    SimulinkM,
    /// A module without dependencies.
    Python,
    /// Settings of this project's own console: friction and gravity compensation.
    Console,
}

/// A model in a format.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The file.
    pub text: String,
    /// What of the device is in it by another law, and how.
    pub approximated: Vec<(Part, &'static str)>,
    /// What of the device is not in it.
    pub left_out: Vec<Part>,
}

/// Writes `model`.
pub fn exported(model: &Model, format: Format) -> Exported {
    let writer: &dyn Writer = match format {
        Format::Mjcf => &mjcf::Mjcf,
        Format::Urdf => &urdf::Urdf,
        Format::Usd => &usd::Usd,
        Format::SimulinkM => &simulink::Simulink,
        Format::Python => &python::Python,
        Format::Console => &console::Console,
    };
    let present = parts(&model.device);
    let approximated: Vec<(Part, &'static str)> = present
        .iter()
        .filter_map(|part| Some((*part, writer.approximates(*part)?)))
        .collect();
    let is_left_out = |part: &&Part| {
        !writer.expresses(**part) && approximated.iter().all(|(other, _)| other != *part)
    };
    let left_out: Vec<Part> = present.iter().filter(is_left_out).copied().collect();
    let mut notes = vec![format!("{}, exported by paddle", model.name)];
    notes.extend(
        approximated
            .iter()
            .map(|(part, how)| format!("{}: {how}", part.name())),
    );
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.iter().map(|part| part.name()).collect();
        notes.push(format!(
            "not expressed in this format: {}",
            names.join(", ")
        ));
    }
    Exported {
        text: writer.text(model, &notes),
        approximated,
        left_out,
    }
}

/// One format.
trait Writer {
    /// Whether the part is in the file as it is.
    fn expresses(&self, part: Part) -> bool;

    /// How a part is in the file by another law; none if it is not or as it is.
    fn approximates(&self, _: Part) -> Option<&'static str> {
        None
    }

    /// The file, with `notes` as comments at its head.
    fn text(&self, model: &Model, notes: &[String]) -> String;
}

/// A number as short as reads back to the same.
fn number(value: f64) -> String {
    format!("{value:?}")
}
