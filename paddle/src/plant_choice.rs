//! Which paddle is simulated.

use crate::device_file::{self, DeviceFile};
use crate::failure::Failure;
use haptic_paddle::settings::Settings;
use host_sim::device::Device;
use host_sim::effects::{Effect, check_distinct};
use host_sim::presets;
use recording::Model;
use std::convert::Infallible;
use std::path::PathBuf;
use std::str::FromStr;

/// A paddle by name or by file.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantChoice {
    /// The lab's nominal model.
    Nominal,
    /// The model refitted to the lab's step logs.
    Refit,
    /// A saved model, or what differs from the nominal one.
    File(PathBuf),
}

impl PlantChoice {
    /// The file, if it is one.
    pub fn file(&self) -> Option<&PathBuf> {
        match self {
            Self::File(path) => Some(path),
            Self::Nominal | Self::Refit => None,
        }
    }
}

impl FromStr for PlantChoice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "nominal" => Self::Nominal,
            "refit" => Self::Refit,
            file => Self::File(file.into()),
        })
    }
}

impl std::fmt::Display for PlantChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nominal => f.write_str("nominal"),
            Self::Refit => f.write_str("refit"),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

/// What a choice comes to.
#[derive(Debug)]
pub struct Plant {
    /// What is simulated.
    pub device: Device,
    /// What a recording of it states as its nominal model.
    pub model: Model,
    /// Settings of the control core.
    pub settings: Settings,
    /// What of a file could not be used, lines ended.
    pub warnings: String,
    /// Effects that a file switches in.
    pub with: Vec<Effect>,
    /// Whether a file had settings of the control core.
    pub has_settings: bool,
}

impl Plant {
    /// Switches further effects in.
    ///
    /// # Errors
    /// [`Failure::Effect`] if one is there twice.
    pub fn install(&mut self, effects: &[Effect]) -> Result<(), Failure> {
        check_distinct(self.with.iter().chain(effects))?;
        for effect in effects {
            effect.install(&mut self.device);
        }
        Ok(())
    }
}

impl PlantChoice {
    /// The paddle and the settings that come with it.
    ///
    /// # Errors
    /// [`Failure`] for a file that cannot be used.
    pub fn load(&self) -> Result<Plant, Failure> {
        let model = presets::nominal();
        let mut settings = Settings::default();
        let mut warnings = String::new();
        let (mut with, mut has_settings) = (Vec::new(), false);
        let (device, model) = match self {
            Self::Nominal => (Device::nominal(&model), model),
            Self::Refit => (presets::refit(), model),
            Self::File(path) if device_file::stands_alone(path)? => {
                let (corrected, left_out) =
                    device_file::saved_model(path, None)?
                        .apart()
                        .map_err(|cause| Failure::ModelFile {
                            path: path.clone(),
                            cause,
                        })?;
                for effect in left_out {
                    warnings.push_str(&format!("warning: {effect}\n"));
                }
                with.extend(
                    corrected
                        .effects
                        .iter()
                        .map(|corrected| corrected.effect.clone()),
                );
                (corrected.device(), corrected.model)
            }
            Self::File(path) => {
                let file = DeviceFile::read(path)?;
                file.apply(&mut settings)?;
                with.extend_from_slice(file.effects());
                has_settings = file.has_settings();
                (file.device(&model)?, file.model(&model)?)
            }
        };
        Ok(Plant {
            device,
            model,
            settings,
            warnings,
            with,
            has_settings,
        })
    }
}
