//! Gains of the position regulator, as people type them.

use haptic_paddle::settings::SettingError;
use haptic_paddle::settings::Settings;
use serde_json::{Value, json};

/// A PID in the console's units, torque at the paddle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains {
    /// N m per degree.
    pub kp: f64,
    /// N m per degree and second.
    pub ki: f64,
    /// N m s per degree.
    pub kd: f64,
}

/// Digits that are worth typing.
const DIGITS: i32 = 3;

impl Gains {
    /// A proportional gain alone.
    pub fn proportional(kp: f64) -> Self {
        Self {
            kp,
            ..Self::default()
        }
    }

    /// A gain on the term at `place` alone: proportional, integral, derivative.
    pub fn only(place: usize, gain: f64) -> Self {
        let at = |other| if place == other { gain } else { 0.0 };
        Self {
            kp: at(0),
            ki: at(1),
            kd: at(2),
        }
    }

    /// With as many digits as are worth typing.
    pub fn rounded(self) -> Self {
        let Self { kp, ki, kd } = self;
        let [kp, ki, kd] = [kp, ki, kd].map(rounded);
        Self { kp, ki, kd }
    }

    fn named(&self) -> [(&'static str, f64); 3] {
        [("kp", self.kp), ("ki", self.ki), ("kd", self.kd)]
    }

    /// Lines for the console.
    pub fn lines(&self) -> String {
        let lines = self.named();
        lines
            .map(|(name, value)| format!("set {name} {value}\n"))
            .concat()
    }

    /// Puts them into `settings` by way of the text that the console gets.
    ///
    /// # Errors
    /// [`SettingError`] for gains beyond the console's bounds.
    pub fn put(&self, settings: &mut Settings) -> Result<(), SettingError> {
        for (name, value) in self.named() {
            settings.set(name, &value.to_string())?;
        }
        Ok(())
    }

    /// For programs.
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
    // A number that was just written as one is one.
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_console_takes_the_lines_as_they_are() {
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
