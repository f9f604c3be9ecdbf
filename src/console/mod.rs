//! The console: it turns a line into an answer. It has no hardware access, so that it runs equally on the device, in the
//! simulator and in tests. A [`Session`] processes bytes one by one.
//!
//! [`parse`] and the text of an [`Answer`] do not access the controller. Only [`execute`] does, and only briefly. A slow
//! terminal therefore never delays the control loop.

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

/// The device as the console accesses it: the controller or the lock that guards it, the telemetry, and the settings store.
pub trait Device {
    /// Runs `work` with the controller.
    fn with<R>(&mut self, work: impl FnOnce(&mut Controller) -> R) -> R;

    /// Runs `work` with the telemetry. Returns `None` without telemetry.
    fn telemetry<R>(&mut self, work: impl FnOnce(&mut Telemetry) -> R) -> Option<R> {
        let _ = work;
        None
    }

    /// Duration of the control interrupt. `None` where it is not measured.
    fn timing(&mut self) -> Option<Timing> {
        None
    }

    /// Restarts the device, as a reset does.
    fn reboot(&mut self) {}

    /// Stores settings permanently. It takes up to two seconds, during which nothing else runs.
    ///
    /// # Errors
    ///
    /// [`StoreError`], for example while the paddle is armed.
    fn save(&mut self, _settings: &Settings) -> Result<(), StoreError> {
        Err(StoreError::NoStore)
    }

    /// Loads the settings that were stored last.
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

/// The output of the console.
pub trait Terminal: fmt::Write {
    /// Returns true if [`MAX_ANSWER_BYTES`] fit into the output now.
    fn has_room(&self) -> bool;
}

/// Largest length of a line of an answer, bytes.
pub const MAX_ANSWER_BYTES: usize = 512;

#[cfg(not(target_os = "none"))]
impl Terminal for std::string::String {
    fn has_room(&self) -> bool {
        true
    }
}

/// Executes a command.
///
/// # Errors
///
/// [`Refusal`]. Nothing is changed in that case.
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
        // A [`Session`] runs procedures.
        Command::Procedure(_) => {}
        // The session adds the rest of the greeting.
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

/// Starts an excitation whose numbers are in user units.
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

/// Value of one user unit in the controller's unit. The user unit is degrees in position mode and N m at the motor in torque
/// mode.
fn per_shown_unit(mode: Mode) -> f32 {
    if mode == Mode::Torque {
        1.0
    } else {
        RAD_PER_DEG
    }
}
