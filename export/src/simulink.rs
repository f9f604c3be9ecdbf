//! A MATLAB function for a "MATLAB Function" block in Simulink with a fixed step.

use crate::model::Model;
use crate::part::Part;
use crate::python::{numbers, steps};
use crate::writer::{Writer, number};
use std::fmt::Write;

pub(crate) struct Simulink;

impl Writer for Simulink {
    fn expresses(&self, part: Part) -> bool {
        steps(part)
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let mut text =
            String::from("function reading = device_step(u, dt, position0, velocity0)\n");
        // Writing to a `String` cannot fail.
        for note in notes {
            let _ = writeln!(text, "% {note}");
        }
        let _ = writeln!(
            text,
            "% SI units. Put it into a MATLAB Function block with a fixed step dt of at most 1e-4 s."
        );
        for (name, value) in numbers(model) {
            let shown = match value {
                f64::INFINITY => "Inf".to_owned(),
                f64::NEG_INFINITY => "-Inf".to_owned(),
                value => number(value),
            };
            let _ = writeln!(text, "p.{name} = {shown};");
        }
        text.push_str(include_str!("step.m"));
        text
    }
}
