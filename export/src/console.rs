//! Settings of this project's console that compensate friction and gravity, one `set` command per line.

use crate::model::Model;
use crate::part::Part;
use crate::writer::Writer;
use std::fmt::Write;

pub(crate) struct Console;

impl Writer for Console {
    fn expresses(&self, part: Part) -> bool {
        matches!(
            part,
            Part::Coulomb | Part::AsymmetricCoulomb | Part::Viscous | Part::Gravity
        )
    }

    fn approximates(&self, part: Part) -> Option<&'static str> {
        match part {
            Part::Stribeck => {
                Some("the sliding level alone, so that it never pushes more than friction holds")
            }
            Part::PositionDependentCoulomb => Some("its level at position 0"),
            _ => None,
        }
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let device = &model.device;
        let mechanics = &device.mechanics;
        let mut text = String::new();
        // Writing to a `String` cannot fail.
        let mut line = |written: String| {
            let _ = writeln!(text, "{written}");
        };
        for note in notes {
            line(format!("# {note}"));
        }
        let [forward, backward] = mechanics.friction.level_nm;
        if forward > 0.0 || backward > 0.0 {
            // The dry friction in the console's settings is at the motor.
            let at_motor = |level: f64| number(level / device.drive.ratio.abs());
            line(format!(
                "set compensation.dry_forward {}",
                at_motor(forward)
            ));
            line(format!(
                "set compensation.dry_backward {}",
                at_motor(backward)
            ));
            line("set compensation.dry on".into());
        }
        if mechanics.viscous > 0.0 {
            line(format!(
                "set compensation.viscous_level {}",
                number(mechanics.viscous)
            ));
            line("set compensation.viscous on".into());
        }
        if mechanics.gravity != 0.0 {
            line(format!(
                "set compensation.gravity_level {}",
                number(mechanics.gravity)
            ));
            line(format!(
                "set compensation.gravity_zero {}",
                number(mechanics.gravity_zero.to_degrees())
            ));
            line("set compensation.gravity on".into());
        }
        text
    }
}

/// A number as a setting, in single precision and without an exponent.
#[expect(
    clippy::cast_possible_truncation,
    reason = "the console's numbers are of single precision"
)]
fn number(value: f64) -> String {
    (value as f32).to_string()
}
