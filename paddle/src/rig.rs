//! Prepares a board on a serial port for experiments.

use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress;
use crate::settings_file;
use chrono::{SecondsFormat, Utc};
use haptic_paddle::settings::Settings;
use remote::{Device, DeviceError, Plan, Progress, SerialWire, Taken, Wire, take};
use std::fmt::Write;

/// Default rows per second: 20 per shortest visible time constant of the paddle.
pub const ROWS_HZ: f64 = 1000.0;

/// A board that is ready for experiments.
pub struct Rig<W: Wire = SerialWire> {
    /// The connection to the board.
    pub device: Device<W>,
    /// The settings of the board when it was prepared.
    pub settings: Settings,
    /// The firmware version that the board reports.
    version: String,
    port: String,
    begun: String,
    /// The executed experiments as text.
    log: Vec<String>,
}

impl Rig {
    /// Opens the serial port and prepares the board as [`Self::on`] does.
    ///
    /// # Errors
    /// Returns [`Failure::Device`] if the board does not answer.
    pub fn open(port: &str) -> Result<Self, Failure> {
        Self::on(SerialWire::open(port)?, port)
    }
}

impl<W: Wire> Rig<W> {
    /// Connects to the board on `wire`. If the encoder has no reference, calibrates it with the Hall sensor. Activates the
    /// host watchdog, so that the board disarms if this program stops. `port` is the name of the connection for the user.
    ///
    /// # Errors
    /// Returns [`Failure::Device`] if the board does not answer.
    pub fn on(wire: W, port: &str) -> Result<Self, Failure> {
        progress::doing(format!("looking for the board on {port}"));
        let mut device = Device::find(wire)?;
        let version = device.command("version")?;
        let version = version.lines().next().unwrap_or_default();
        let version = if version.contains("no such command") {
            "unknown"
        } else {
            version
        };
        device.speed_up()?;
        device.command("disarm")?;
        if device.command("status")?.contains("no zero") {
            device.expect("zero hall", "zeroed")?;
        }
        let settings = device.settings()?;
        device.steer(true)?;
        Ok(Self {
            version: version.to_owned(),
            device,
            settings,
            port: port.to_owned(),
            begun: Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true),
            log: Vec::new(),
        })
    }

    /// Runs an experiment.
    ///
    /// # Errors
    /// Returns [`DeviceError`] if the board refuses the experiment or is lost.
    pub fn take(
        &mut self,
        plan: &Plan,
        rate_hz: f64,
        interrupt: &Interrupt,
    ) -> Result<Taken, DeviceError> {
        progress::doing(format!("{plan}, {:.0} s", plan.whole_s()));
        progress::begin();
        let taken = take(&mut self.device, plan, rate_hz, &mut Shown(interrupt));
        self.log.push(match &taken {
            Ok(Taken {
                fault: Some(fault), ..
            }) => format!("{plan}: ended by a fault: {fault}"),
            Ok(_) => plan.to_string(),
            Err(error) => format!("{plan}: {error}"),
        });
        taken
    }

    /// Hands the board over to a user at a terminal.
    ///
    /// # Errors
    /// Returns [`DeviceError`] if the board does not answer.
    pub fn leave(&mut self) -> Result<(), DeviceError> {
        self.device.command("disarm")?;
        self.device.steer(false)?;
        self.device.slow_down()
    }

    /// The board, its settings and the executed experiments, as TOML.
    pub fn account(&self) -> String {
        let mut text = String::new();
        let quoted = |text: &str| toml::Value::from(text).to_string();
        for (key, value) in [
            ("program", concat!("paddle ", env!("CARGO_PKG_VERSION"))),
            ("commit", env!("PADDLE_COMMIT")),
            ("firmware", &self.version),
            ("port", &self.port),
            ("begun", &self.begun),
        ] {
            let _ = writeln!(text, "{key} = {}", quoted(value));
        }
        let _ = writeln!(text, "experiments = [");
        for line in &self.log {
            let _ = writeln!(text, "    {},", quoted(line));
        }
        let _ = write!(text, "]\n\n{}", settings_file::text(&self.settings));
        text
    }
}

/// Shows the progress of a run and checks for an interruption by the user.
struct Shown<'a>(&'a Interrupt);

impl Progress for Shown<'_> {
    fn done(&mut self, share: f64) {
        progress::part_done(share);
    }

    fn ends(&self) -> bool {
        self.0.is_requested()
    }
}
