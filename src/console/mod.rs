//! The console: a line in, an answer out. Pure, so that it runs the same on the device, in the simulator and in a
//! test. A [`Session`] is all of it together, byte by byte.
//!
//! [`parse`] needs no access to the controller, and neither does writing an [`Answer`]: only [`execute`] does, for
//! moments, so that a slow terminal never holds the control loop up.

mod answer;
mod command;
mod line;
mod session;
mod telemetry;

pub use answer::{Answer, Refusal};
pub use command::{COMMANDS, Command, MAX_LINE_BYTES, ParseError, Topic, Usage, Zero, parse};
pub use line::{LineEditor, STOP_BYTE, Typed};
pub use session::Session;
pub use telemetry::{TelemetryAnswer, TelemetryCommand, TelemetryRefusal};

use core::fmt;

use crate::controller::{Controller, Mode, TickRate, Tuning};
use crate::excitation::Excitation;
use crate::settings::Settings;
use crate::telemetry::Telemetry;
use crate::units::RAD_PER_DEG;

/// Somebody who lends the controller out: the controller itself, or the lock that guards it.
pub trait Lender {
    /// Runs `work` with the controller.
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R;

    /// Runs `work` with the telemetry, where there is one.
    fn telemetry<R>(&mut self, work: impl FnOnce(&mut Telemetry) -> R) -> Option<R> {
        let _ = work;
        None
    }
}

impl Lender for Controller {
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R {
        work(self)
    }
}

/// Where the console writes.
pub trait Terminal: fmt::Write {
    /// Whether [`MAX_ANSWER_BYTES`] fit now.
    fn has_room(&self) -> bool;
}

/// No line of an answer is longer, bytes.
pub const MAX_ANSWER_BYTES: usize = 512;

#[cfg(not(target_os = "none"))]
impl Terminal for std::string::String {
    fn has_room(&self) -> bool {
        true
    }
}

/// Does what a command says.
///
/// # Errors
/// [`Refusal`], with nothing changed.
pub fn execute(
    command: &Command,
    settings: &mut Settings,
    rate: TickRate,
    controller: &mut impl Lender,
) -> Result<Answer, Refusal> {
    match *command {
        Command::Help(topic) => return Ok(Answer::Help(topic, *settings)),
        Command::Get(fields) => return Ok(Answer::Settings(fields, *settings)),
        Command::Dump => return Ok(Answer::Dump(*settings)),
        Command::Set(field, value) => {
            field.write(settings, value)?;
            let tuning = Tuning::new(settings, rate);
            controller.with(|c| c.retune(tuning));
            return Ok(Answer::Changed(field.shown(settings)));
        }
        Command::Arm(mode) => controller.with(|c| c.arm(mode))?,
        Command::Disarm => controller.with(Controller::disarm),
        Command::Clear => controller.with(Controller::clear_fault),
        Command::Zero(Zero::Hall) => controller.with(Controller::zero_from_hall)?,
        Command::Zero(Zero::At { angle_deg }) => {
            controller.with(|c| c.zero_at(angle_deg * RAD_PER_DEG))?
        }
        Command::Reference(value) => {
            controller.with(|c| c.set_reference(value * per_shown_unit(c.mode())))?
        }
        Command::Start(excitation) => controller.with(|c| {
            let unit = per_shown_unit(c.mode());
            c.start(&Excitation {
                amplitude: excitation.amplitude * unit,
                offset: excitation.offset * unit,
                ..excitation
            })
        })?,
        Command::Stop => controller.with(Controller::stop),
        Command::Faults => {
            return Ok(controller.with(|c| Answer::Faults(*c.faults(), c.counters())));
        }
        Command::Telemetry(wanted) => {
            return Ok(Answer::Telemetry(telemetry::execute(wanted, controller)?));
        }
        Command::Beat => return Ok(Answer::Beat),
        Command::Baud(baud) => return Ok(Answer::Baud(baud)),
        Command::Status => {}
    }
    Ok(Answer::Status(controller.with(|c| c.status())))
}

/// The controller's unit in one unit that people type: degrees in position mode, N m at the motor in torque mode.
fn per_shown_unit(mode: Mode) -> f32 {
    if mode == Mode::Torque {
        1.0
    } else {
        RAD_PER_DEG
    }
}
