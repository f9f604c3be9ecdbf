//! Options that define a closed loop.

use crate::answer::short;
use crate::failure::Failure;
use crate::numbers;
use crate::plant_choice::{Plant, PlantChoice};
use clap::{Args, ValueEnum};
use haptic_paddle::settings::{FIELDS, Kind};
use haptic_paddle::settings::{Sensor, Settings};
use host_sim::closed_loop::LoopSetup;
use host_sim::effects::Effect;
use host_sim::presets;
use recording::Model;
use serde_json::{Map, Value, json};

/// The paddle, its effects, and its controller.
#[derive(Args, Clone, Debug)]
pub struct Rig {
    /// Paddle model: `nominal`, `refit`, a file that `paddle gap diagnose --save-model` wrote, or a TOML file with the
    /// changes from nominal: [model], [settings] and with = ["effect"].
    #[arg(
        long,
        default_value = "nominal",
        value_name = "nominal|refit|FILE.toml"
    )]
    pub plant: PlantChoice,
    /// Add this effect to the paddle; may be repeated. `paddle effects` lists the effects.
    #[arg(long, value_name = "EFFECT:PARAMETER=VALUE,...")]
    pub with: Vec<Effect>,
    /// Sensor that feeds the regulator.
    #[arg(long, value_enum)]
    pub sensor: Option<SensorChoice>,
    /// Cutoff of the low-pass on the position, Hz; 0 disables it.
    #[arg(long, value_name = "Hz", value_parser = numbers::setting)]
    pub cutoff: Option<f32>,
    /// Any other setting of the control core, as on its console; may be repeated.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Simulate the 20 kHz current loop with bridge and winding, instead of the lab's 350 µs loop with an ideal torque.
    #[arg(long)]
    pub current_loop: bool,
    /// Seed of the random noise.
    #[arg(long, default_value_t = 0, value_parser = numbers::whole)]
    pub seed: u64,
}

/// Gains of the regulator that replace the default gains.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct GainChoice {
    /// Proportional gain, N m per degree at the paddle.
    #[arg(long, value_name = "N m/deg", value_parser = numbers::setting)]
    pub kp: Option<f32>,
    /// Integral gain, N m per degree and second at the paddle.
    #[arg(long, value_name = "N m/(deg s)", value_parser = numbers::setting)]
    pub ki: Option<f32>,
    /// Derivative gain, N m s per degree at the paddle.
    #[arg(long, value_name = "N m s/deg", value_parser = numbers::setting)]
    pub kd: Option<f32>,
}

/// A closed loop that is ready to be simulated.
#[derive(Debug)]
pub struct Assembly {
    /// The closed loop.
    pub setup: LoopSetup,
    /// Nominal model of a recording of the loop.
    pub model: Model,
    /// Warnings about the files that were read. Every line ends with a newline.
    pub warnings: String,
}

/// The sensor of the regulator: the encoder on the motor, or the Hall sensor on the paddle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SensorChoice {
    Encoder,
    Hall,
}

impl Default for Rig {
    /// The refitted paddle of the lab.
    fn default() -> Self {
        Self {
            plant: PlantChoice::Refit,
            with: Vec::new(),
            sensor: None,
            cutoff: None,
            set: Vec::new(),
            current_loop: false,
            seed: 0,
        }
    }
}

impl Rig {
    /// Creates the closed loop.
    ///
    /// # Errors
    /// Returns a [`Failure`] if a file or a setting cannot be used.
    pub fn assemble(&self) -> Result<Assembly, Failure> {
        let mut plant = self.plant.load()?;
        plant.install(&self.with)?;
        let Plant {
            device,
            model,
            mut settings,
            warnings,
            ..
        } = plant;
        self.apply(&mut settings)?;
        let mut setup = match self.current_loop {
            true => LoopSetup::firmware(device, settings, presets::motor()),
            false => LoopSetup::ideal(device, settings),
        };
        setup.paddle.seed = self.seed;
        Ok(Assembly {
            setup,
            model,
            warnings,
        })
    }

    fn apply(&self, settings: &mut Settings) -> Result<(), Failure> {
        if let Some(cutoff) = self.cutoff {
            set(settings, "estimate.cutoff", &cutoff.to_string())?;
        }
        for setting in &self.set {
            let (name, value) = setting
                .split_once('=')
                .ok_or_else(|| Failure::NotASetting(setting.clone()))?;
            set(settings, name.trim(), value.trim())?;
        }
        if let Some(sensor) = self.sensor {
            settings.estimate.sensor = match sensor {
                SensorChoice::Encoder => Sensor::Encoder,
                SensorChoice::Hall => Sensor::Hall,
            };
        }
        Ok(())
    }

    /// The simulated loop as JSON, complete enough to repeat the simulation.
    pub fn json(&self, setup: &LoopSetup) -> Value {
        let effects = self.with.iter().map(|effect| {
            let count = effect.values.len();
            let values = effect.values.iter().enumerate();
            let named =
                values.map(|(place, value)| (effect.kind.value_name(place, count), json!(value)));
            json!({ "name": effect.kind.name, "parameters": named.collect::<Map<_, _>>() })
        });
        let settings = FIELDS.iter().map(|field| {
            let value = field.read(&setup.settings);
            let value = match field.kind {
                Kind::Number { .. } => json!(short(value)),
                // A choice is stored as the index of its name.
                Kind::Choice(names) => json!(names.get(value as usize)),
            };
            (field.name.to_owned(), value)
        });
        json!({
            "plant": self.plant.to_string(),
            "with": effects.collect::<Vec<_>>(),
            "seed": self.seed,
            "current_loop": self.current_loop,
            "settings": settings.collect::<Map<_, _>>(),
        })
    }

    /// A short title.
    pub fn title(&self, settings: &Settings) -> String {
        let sensor = match settings.estimate.sensor {
            Sensor::Encoder => "encoder",
            Sensor::Hall => "Hall",
        };
        let mut title = format!("{sensor}, plant {}", self.plant);
        for effect in &self.with {
            title.push_str(" + ");
            title.push_str(effect.kind.name);
        }
        title
    }
}

/// The gains in `settings` as JSON.
pub fn gains(settings: &Settings) -> Value {
    json!({
        "kp_nm_per_deg": short(settings.pid.kp_nm_per_deg),
        "ki_nm_per_deg_s": short(settings.pid.ki_nm_per_deg_s),
        "kd_nm_s_per_deg": short(settings.pid.kd_nm_s_per_deg),
    })
}

impl GainChoice {
    /// Writes the given gains to `settings`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if a gain is refused.
    pub fn apply(&self, settings: &mut Settings) -> Result<(), Failure> {
        let named = [
            ("pid.kp", self.kp),
            ("pid.ki", self.ki),
            ("pid.kd", self.kd),
        ];
        for (name, value) in named {
            if let Some(value) = value {
                set(settings, name, &value.to_string())?;
            }
        }
        Ok(())
    }
}

fn set(settings: &mut Settings, name: &str, value: &str) -> Result<(), Failure> {
    match settings.set(name, value) {
        Ok(_) => Ok(()),
        Err(error) => Err(Failure::setting(name, error)),
    }
}
