//! The console: a line in, an answer out. Pure, so that it runs the same on the device, in the simulator and in a
//! test. A [`Session`] is all of it together, byte by byte.
//!
//! [`parse`] needs no access to the controller, and neither does writing an [`Answer`]: only [`execute`] does, for
//! moments, so that a slow terminal never holds the control loop up.

mod answer;
mod command;
mod complete;
mod line;
mod session;
mod telemetry;

pub use answer::{Answer, Refusal, Timing};
pub use command::{COMMANDS, Command, MAX_LINE_BYTES, ParseError, Topic, Usage, Zero, parse};
pub use line::{Edited, LineEditor, STOP_BYTE, Typed};
pub use session::Session;
pub use telemetry::{TelemetryAnswer, TelemetryCommand, TelemetryRefusal};

use core::fmt;

use crate::controller::{Controller, Mode, TickRate, Tuning};
use crate::excitation::{Excitation, ExcitationError};
use crate::settings::{Recalled, Settings, StoreError};
use crate::telemetry::Telemetry;
use crate::units::RAD_PER_DEG;

/// What the console reaches of the device: the controller itself, or the lock that guards it, telemetry and a memory.
pub trait Device {
    /// Runs `work` with the controller.
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R;

    /// Runs `work` with the telemetry, where there is one.
    fn telemetry<R>(&mut self, work: impl FnOnce(&mut Telemetry) -> R) -> Option<R> {
        let _ = work;
        None
    }

    /// How long the control interrupt takes, where that is measured.
    fn timing(&mut self) -> Option<Timing> {
        None
    }

    /// Begins anew, as after a reset.
    fn reboot(&mut self) {}

    /// Stores settings so that they outlive a loss of the supply. Takes up to two seconds, in which nothing else runs.
    ///
    /// # Errors
    /// [`StoreError`], armed at the latest.
    fn save(&mut self, _settings: &Settings) -> Result<(), StoreError> {
        Err(StoreError::NoStore)
    }

    /// The settings that were stored last.
    ///
    /// # Errors
    /// [`StoreError`].
    fn load(&mut self) -> Result<Recalled, StoreError> {
        Err(StoreError::NoStore)
    }
}

impl Device for Controller {
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
    device: &mut impl Device,
) -> Result<Answer, Refusal> {
    match *command {
        Command::Help(topic) => return Ok(Answer::Help(topic, *settings)),
        Command::Get(fields) => return Ok(Answer::Settings(fields, *settings)),
        Command::Dump => return Ok(Answer::Dump(*settings)),
        Command::Set(field, value) => {
            field.write(settings, value)?;
            let tuning = Tuning::new(settings, rate);
            device.with(|c| c.retune(tuning));
            return Ok(Answer::Changed(field.shown(settings)));
        }
        Command::Save => {
            disarmed(device)?;
            device.save(settings)?;
            return Ok(Answer::Saved);
        }
        Command::Load => {
            disarmed(device)?;
            let recalled = device.load()?;
            replace(settings, &recalled.settings, rate, device);
            return Ok(Answer::Loaded(recalled.left_out));
        }
        Command::Defaults => {
            disarmed(device)?;
            replace(settings, &Settings::default(), rate, device);
            return Ok(Answer::Defaults);
        }
        Command::Arm(mode) => device.with(|c| c.arm(mode))?,
        Command::Disarm => device.with(Controller::disarm),
        Command::Clear => device.with(Controller::clear_fault),
        Command::Zero(Zero::Hall) => device.with(Controller::zero_from_hall)?,
        Command::Zero(Zero::At { angle_deg }) => {
            device.with(|c| c.zero_at(angle_deg * RAD_PER_DEG))?
        }
        Command::Reference(value) => {
            device.with(|c| c.set_reference(value * per_shown_unit(c.mode())))?
        }
        Command::Start(excitation) => {
            excitation.check_sense()?;
            device.with(|c| start(c, &excitation))?;
        }
        Command::Stop => device.with(Controller::stop),
        Command::Faults => {
            return Ok(device.with(|c| Answer::Faults(*c.faults(), c.counters())));
        }
        Command::Telemetry(wanted) => {
            return Ok(Answer::Telemetry(telemetry::execute(wanted, device)?));
        }
        Command::Beat(_) => return Ok(Answer::Beat),
        Command::Timing => return Ok(Answer::Timing(device.timing())),
        // A session has procedures.
        Command::Procedure(_) => {}
        // The part of the greeting that needs no session.
        Command::Version | Command::Hello => return Ok(Answer::Version),
        Command::Reboot => {
            disarmed(device)?;
            device.reboot();
        }
        Command::Baud(baud) => return Ok(Answer::Baud(baud)),
        Command::Status => {}
    }
    Ok(Answer::Status(device.with(|c| c.status())))
}

/// Starts a test signal whose numbers are in the unit that people type.
fn start(controller: &mut Controller, excitation: &Excitation) -> Result<(), ExcitationError> {
    let unit = per_shown_unit(controller.mode());
    controller.start(&Excitation {
        amplitude: excitation.amplitude * unit,
        offset: excitation.offset * unit,
        ..*excitation
    })
}

/// # Errors
/// [`StoreError::Armed`] while the paddle is armed.
fn disarmed(device: &mut impl Device) -> Result<(), StoreError> {
    match device.with(|c| c.mode()) {
        Mode::Off => Ok(()),
        _ => Err(StoreError::Armed),
    }
}

fn replace(settings: &mut Settings, by: &Settings, rate: TickRate, device: &mut impl Device) {
    *settings = *by;
    let tuning = Tuning::new(settings, rate);
    device.with(|c| c.retune(tuning));
}

/// The controller's unit in one unit that people type: degrees in position mode, N m at the motor in torque mode.
fn per_shown_unit(mode: Mode) -> f32 {
    if mode == Mode::Torque {
        1.0
    } else {
        RAD_PER_DEG
    }
}
