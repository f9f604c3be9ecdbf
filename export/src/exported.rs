//! A model in a format, with the parts that it does not contain.

use crate::console::Console;
use crate::format::Format;
use crate::mjcf::Mjcf;
use crate::model::Model;
use crate::part::{Part, parts};
use crate::python::Python;
use crate::simulink::Simulink;
use crate::urdf::Urdf;
use crate::usd::Usd;
use crate::writer::Writer;

/// A model in a format.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The content of the file.
    pub text: String,
    /// Parts that are approximated, each with the approximation in words.
    pub approximated: Vec<(Part, &'static str)>,
    /// Parts that are missing.
    pub left_out: Vec<Part>,
}

/// Writes `model` in a format.
pub fn exported(model: &Model, format: Format) -> Exported {
    let writer: &dyn Writer = match format {
        Format::Mjcf => &Mjcf,
        Format::Urdf => &Urdf,
        Format::Usd => &Usd,
        Format::SimulinkM => &Simulink,
        Format::Python => &Python,
        Format::Console => &Console,
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
    // A comment must be one line, whatever the name contains.
    let name = model.name.replace(char::is_control, " ");
    let mut notes = vec![format!("{name}, exported by paddle")];
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
