//! Selects the simulated paddle.

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
    /// A saved model, or a file with the changes from the nominal model.
    File(PathBuf),
}

impl PlantChoice {
    /// The file, if the paddle is selected by file.
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

/// The selected paddle with its settings.
#[derive(Debug)]
pub struct Plant {
    /// The simulated device.
    pub device: Device,
    /// The nominal model of a recording of the device.
    pub model: Model,
    /// Settings of the control core.
    pub settings: Settings,
    /// Warnings about parts of the file that could not be used. Every line ends with a newline.
    pub warnings: String,
    /// Effects that the file adds.
    pub with: Vec<Effect>,
    /// Whether the file has settings of the control core.
    pub has_settings: bool,
}

impl Plant {
    /// Adds further effects.
    ///
    /// # Errors
    /// Returns [`Failure::Effect`] if an effect is added twice.
    pub fn install(&mut self, effects: &[Effect]) -> Result<(), Failure> {
        check_distinct(self.with.iter().chain(effects))?;
        for effect in effects {
            effect.install(&mut self.device);
        }
        Ok(())
    }
}

impl PlantChoice {
    /// Loads the paddle and its settings.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the file cannot be used.
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
