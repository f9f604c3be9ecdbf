//! A board on a serial port, made ready for experiments.

use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress;
use crate::settings_file;
use chrono::{SecondsFormat, Utc};
use haptic_paddle::settings::Settings;
use remote::{Device, DeviceError, Plan, Progress, SerialWire, Taken, Wire, take};
use std::fmt::Write;

/// Rows a second where nothing is said: 20 for the shortest time constant of the paddle that shows.
pub const ROWS_HZ: f64 = 1000.0;

/// The board.
pub struct Rig<W: Wire = SerialWire> {
    /// It.
    pub device: Device<W>,
    /// Its settings when it was made ready.
    pub settings: Settings,
    /// What it says of its firmware.
    version: String,
    port: String,
    begun: String,
    /// What was done, for people.
    log: Vec<String>,
}

impl Rig {
    /// As [`Self::on`], of the board on a serial port.
    ///
    /// # Errors
    /// [`Failure::Device`].
    pub fn open(port: &str) -> Result<Self, Failure> {
        Self::on(SerialWire::open(port)?, port)
    }
}

impl<W: Wire> Rig<W> {
    /// Finds the board on `wire`, gives its encoder a zero by the Hall sensor if it has none, and from now on it disarms
    /// where this program falls silent. `port` is what people call the wire.
    ///
    /// # Errors
    /// [`Failure::Device`].
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

    /// Carries an experiment out.
    ///
    /// # Errors
    /// [`DeviceError`].
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

    /// Leaves the board to a person at a terminal.
    ///
    /// # Errors
    /// [`DeviceError`] if it is gone.
    pub fn leave(&mut self) -> Result<(), DeviceError> {
        self.device.command("disarm")?;
        self.device.steer(false)?;
        self.device.slow_down()
    }

    /// What was done with which board and settings, as TOML.
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

/// The progress of a run, beside the user's wish to end.
struct Shown<'a>(&'a Interrupt);

impl Progress for Shown<'_> {
    fn done(&mut self, share: f64) {
        progress::part_done(share);
    }

    fn ends(&self) -> bool {
        self.0.is_wished()
    }
}
