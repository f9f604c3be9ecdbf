//! Units of position and input.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::Oddity;
use crate::keys;

/// Units of position and input, for display. The unit of position also defines the argument of the sine of gravity.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Units {
    /// Unit of position. `rad` if left out.
    pub position: String,
    /// Unit of input. `N m` if left out.
    pub input: String,
}

/// Units of angle, each with its value in rad.
const ANGLES: [(&str, f64); 15] = [
    ("rad", 1.0),
    ("radian", 1.0),
    ("radians", 1.0),
    ("mrad", 1e-3),
    ("deg", PI / 180.0),
    ("°", PI / 180.0),
    ("degree", PI / 180.0),
    ("degrees", PI / 180.0),
    ("arcmin", PI / 180.0 / 60.0),
    ("rev", TAU),
    ("revs", TAU),
    ("revolution", TAU),
    ("revolutions", TAU),
    ("turn", TAU),
    ("turns", TAU),
];
/// Units of length.
const LENGTHS: [&str; 14] = [
    "m",
    "dm",
    "cm",
    "mm",
    "µm",
    "um",
    "nm",
    "in",
    "inch",
    "metre",
    "metres",
    "meter",
    "meters",
    "millimetres",
];
/// SI units of position.
const SI: [&str; 8] = [
    "rad", "radian", "radians", "m", "metre", "metres", "meter", "meters",
];
/// Counts and ratios, for positions and inputs.
const PLAIN: [&str; 17] = [
    "", "1", "-", "%", "percent", "count", "counts", "tick", "ticks", "step", "steps", "lsb",
    "bit", "bits", "digits", "raw", "px",
];
/// Units of input only, without spaces and multiplication signs.
const INPUTS: [&str; 31] = [
    "Nm", "mNm", "Ncm", "Nmm", "kNm", "kgfcm", "kgcm", "gcm", "ozin", "lbfin", "lbfft", "N", "mN",
    "kN", "kg", "g", "A", "mA", "V", "mV", "W", "Pa", "kPa", "bar", "duty", "pwm", "us", "µs",
    "ms", "rpm", "Hz",
];

impl Units {
    /// True if the position is a length. A linear axis has no pendulum.
    pub fn is_length(&self) -> bool {
        LENGTHS.contains(&self.position.trim())
    }

    /// True if the position is in rad or m, so that the model is in SI units.
    pub fn is_si(&self) -> bool {
        SI.contains(&self.position.trim())
    }

    /// Angle of one unit of position, rad, for the sine of gravity. For degrees π/180, otherwise 1.
    pub fn angle_rad(&self) -> f64 {
        let angle = ANGLES
            .iter()
            .find(|(name, _)| *name == self.position.trim());
        angle.map_or(1.0, |(_, rad)| *rad)
    }

    /// Reports unknown units.
    pub(crate) fn oddities(&self) -> Vec<Oddity> {
        let angles = || ANGLES.iter().map(|(name, _)| *name);
        let positions = || angles().chain(LENGTHS).chain(PLAIN);
        let inputs = || INPUTS.into_iter().chain(positions());
        let rate = self.input.trim();
        let rate = rate.strip_suffix("/s").unwrap_or(rate);
        let is_position = positions().any(|name| is_same(name, &self.position));
        let is_input = inputs().any(|name| is_same(name, rate));
        let odd = |column, unit: &str, nearest| Oddity::UnknownUnit {
            column,
            unit: unit.trim().to_owned(),
            nearest,
        };
        let position = (!is_position).then(|| {
            odd(
                "position",
                &self.position,
                keys::nearest(&self.position, positions()),
            )
        });
        let input =
            (!is_input).then(|| odd("input", &self.input, keys::nearest(&self.input, inputs())));
        position.into_iter().chain(input).collect()
    }
}

/// True if two texts are the same unit in different spelling or spacing.
fn is_same(known: &str, written: &str) -> bool {
    let bare = |text: &str| -> String {
        let letters = text.chars().filter(|c| !" *·.".contains(*c));
        letters.flat_map(char::to_lowercase).collect()
    };
    bare(known) == bare(written)
}

impl Default for Units {
    fn default() -> Self {
        Self {
            position: "rad".into(),
            input: "N m".into(),
        }
    }
}
