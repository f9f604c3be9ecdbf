//! `paddle settings`: reads a board's settings into a file, and writes them back.

use crate::answer::Answer;
use crate::device_file::DeviceFile;
use crate::failure::Failure;
use crate::settings_file::{Difference, differences, text, told};
use crate::targets::{Target, Use};
use clap::{Args, Subcommand};
use haptic_paddle::settings::Settings;
use remote::{Device, SerialWire, Wire};
use serde_json::json;
use std::path::PathBuf;

/// Subcommands of `paddle settings`.
#[derive(Subcommand)]
pub enum Command {
    /// Write the board's settings to a file.
    #[command(
        after_help = "Example: paddle settings pull --port /dev/ttyUSB0 my-paddle.toml

The file can be given to `paddle sim` as --plant, too. It says what it would replace."
    )]
    Pull(Way),
    /// Write the settings of a file to the board, and list the changes.
    #[command(after_help = "Examples:
  paddle settings push --port /dev/ttyUSB0 my-paddle.toml --dry-run
  paddle settings push --port /dev/ttyUSB0 my-paddle.toml --save

Settings that the file does not name stay as they are. What the board refuses ends it, with nothing stored.")]
    Push(Push),
}

/// The board and the file.
#[derive(Args)]
pub struct Way {
    /// Serial port of the board, or the terminal that `paddle board` prints.
    #[arg(long)]
    port: String,
    /// TOML file with a table [settings].
    file: PathBuf,
}

/// Options of `paddle settings push`.
#[derive(Args)]
pub struct Push {
    #[command(flatten)]
    way: Way,
    /// List the changes without making them.
    #[arg(long)]
    dry_run: bool,
    /// Store the settings in the board's flash; the board must be disarmed.
    #[arg(long, conflicts_with = "dry_run")]
    save: bool,
}

impl Command {
    /// Paths that the command writes and reads.
    pub fn targets(&self) -> Vec<Target<'_>> {
        let target = match self {
            Self::Pull(way) => Target::of("FILE", Use::File, &way.file),
            Self::Push(push) => Target::of("FILE", Use::Read, &push.way.file),
        };
        target.into_iter().collect()
    }

    /// Runs the command.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the board does not answer, and if the file cannot be used.
    pub fn run(&self) -> Result<Answer, Failure> {
        match self {
            Self::Pull(way) => pull(way),
            Self::Push(push) => push.run(),
        }
    }
}

fn pull(way: &Way) -> Result<Answer, Failure> {
    let settings = Device::find(SerialWire::open(&way.port)?)?.settings()?;
    // A file that is not a settings file is overwritten, and no changes are listed.
    let before = std::fs::metadata(&way.file)
        .ok()
        .filter(|there| there.len() > 0)
        .and_then(|_| applied(&way.file, &Settings::default()).ok());
    std::fs::write(&way.file, text(&settings)).map_err(Failure::write(&way.file))?;
    let changed = before.map_or_else(Vec::new, |before| differences(&before, &settings));
    Ok(answer(
        format!("settings in {}\n{}", way.file.display(), told(&changed)),
        &changed,
    ))
}

impl Push {
    fn run(&self) -> Result<Answer, Failure> {
        let mut device = Device::find(SerialWire::open(&self.way.port)?)?;
        let before = device.settings()?;
        let wanted = applied(&self.way.file, &before)?;
        let changes = differences(&before, &wanted);
        let mut text = match changes.len() {
            0 => "the board has these settings already\n".to_owned(),
            _ => told(&changes),
        };
        if self.dry_run {
            return Ok(answer(text, &changes));
        }
        push(&mut device, &changes)?;
        if self.save {
            let said = device.expect("save", "saved")?;
            text.push_str(&format!("{said}\n"));
        }
        Ok(answer(text, &changes))
    }
}

/// Writes settings to a board one by one, and reads them back.
///
/// # Errors
/// Returns [`remote::DeviceError::Refused`] for the first setting that the board refuses.
pub fn push<W: Wire>(
    device: &mut Device<W>,
    changes: &[Difference],
) -> Result<(), remote::DeviceError> {
    for change in changes {
        let value = &change.values[1];
        device.expect(
            &format!("set {} {value}", change.name),
            &format!("{} = {value}", change.name),
        )?;
    }
    Ok(())
}

/// Applies the settings of a file to `base`.
fn applied(path: &std::path::Path, base: &Settings) -> Result<Settings, Failure> {
    let mut settings = *base;
    DeviceFile::read(path)?.apply(&mut settings)?;
    Ok(settings)
}

fn answer(text: String, changes: &[Difference]) -> Answer {
    let changes = changes.iter().map(|change| {
        let [before, after] = &change.values;
        json!({ "name": change.name, "unit": change.unit, "before": before, "after": after })
    });
    Answer {
        text,
        json: json!({ "changes": changes.collect::<Vec<_>>() }),
        ..Answer::default()
    }
}
