//! Gains of the position regulator with the digits of a typed number.

use haptic_paddle::settings::SettingError;
use haptic_paddle::settings::Settings;
use serde_json::{Value, json};

/// PID gains in the units of the console, for torque at the paddle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains {
    /// Proportional gain, N m per degree.
    pub kp: f64,
    /// Integral gain, N m per degree and second.
    pub ki: f64,
    /// Derivative gain, N m s per degree.
    pub kd: f64,
}

/// Significant digits of a gain.
const DIGITS: i32 = 3;

impl Gains {
    /// Gains with proportional action only.
    pub fn proportional(kp: f64) -> Self {
        Self {
            kp,
            ..Self::default()
        }
    }

    /// Gains with only one term: `place` 0 is proportional, 1 is integral, 2 is derivative.
    pub fn only(place: usize, gain: f64) -> Self {
        let at = |other| if place == other { gain } else { 0.0 };
        Self {
            kp: at(0),
            ki: at(1),
            kd: at(2),
        }
    }

    /// Rounds the gains to [`DIGITS`] significant digits.
    pub fn rounded(self) -> Self {
        let Self { kp, ki, kd } = self;
        let [kp, ki, kd] = [kp, ki, kd].map(rounded);
        Self { kp, ki, kd }
    }

    fn named(&self) -> [(&'static str, f64); 3] {
        [("kp", self.kp), ("ki", self.ki), ("kd", self.kd)]
    }

    /// The gains as commands of the console.
    pub fn lines(&self) -> String {
        let lines = self.named();
        lines
            .map(|(name, value)| format!("set {name} {value}\n"))
            .concat()
    }

    /// Writes the gains to `settings`, with the text that the console would receive.
    ///
    /// # Errors
    /// Returns [`SettingError`] for gains outside the limits of the console.
    pub fn put(&self, settings: &mut Settings) -> Result<(), SettingError> {
        for (name, value) in self.named() {
            settings.set(name, &value.to_string())?;
        }
        Ok(())
    }

    /// The gains as JSON.
    pub fn json(&self) -> Value {
        json!({
            "kp_nm_per_deg": self.kp,
            "ki_nm_per_deg_s": self.ki,
            "kd_nm_s_per_deg": self.kd,
        })
    }
}

fn rounded(value: f64) -> f64 {
    let digits = (DIGITS - 1) as usize;
    // A number that was just formatted always parses.
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_console_accepts_the_commands_unchanged() {
        let gains = Gains {
            kp: 0.031_415_9,
            ki: 0.692,
            kd: 0.000_012_345_6,
        };
        let gains = gains.rounded();
        assert_eq!(
            gains.lines(),
            "set kp 0.0314\nset ki 0.692\nset kd 0.0000123\n"
        );
        let mut settings = Settings::default();
        gains.put(&mut settings).unwrap();
        assert_eq!(settings.pid.kd_nm_s_per_deg, 0.000_012_3);
        assert!(Gains::proportional(1e6).put(&mut settings).is_err());
    }
}
