//! Units of position and input, and what of them is known.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::Oddity;
use crate::keys;

/// Units of position and input, for display; that of position also says what the sine of gravity is taken of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Units {
    /// Unit of position; `rad` if left out.
    pub position: String,
    /// Unit of input; `N m` if left out.
    pub input: String,
}

/// Units of angle, with what one is in rad.
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
/// Units of position in SI.
const SI: [&str; 8] = [
    "rad", "radian", "radians", "m", "metre", "metres", "meter", "meters",
];
/// What is counted, and shares: of positions and of inputs.
const PLAIN: [&str; 17] = [
    "", "1", "-", "%", "percent", "count", "counts", "tick", "ticks", "step", "steps", "lsb",
    "bit", "bits", "digits", "raw", "px",
];
/// Units of input alone, without spaces and signs of multiplication.
const INPUTS: [&str; 31] = [
    "Nm", "mNm", "Ncm", "Nmm", "kNm", "kgfcm", "kgcm", "gcm", "ozin", "lbfin", "lbfft", "N", "mN",
    "kN", "kg", "g", "A", "mA", "V", "mV", "W", "Pa", "kPa", "bar", "duty", "pwm", "us", "µs",
    "ms", "rpm", "Hz",
];

impl Units {
    /// True if the position is a length: that of a linear axis, which has no pendulum.
    pub fn is_length(&self) -> bool {
        LENGTHS.contains(&self.position.trim())
    }

    /// True if the position is in rad or in m, so that the model's numbers are in SI units.
    pub fn is_si(&self) -> bool {
        SI.contains(&self.position.trim())
    }

    /// Angle of one unit of position, rad, for what depends on the sine of it: of degrees what it is, else 1.
    pub fn angle_rad(&self) -> f64 {
        let angle = ANGLES
            .iter()
            .find(|(name, _)| *name == self.position.trim());
        angle.map_or(1.0, |(_, rad)| *rad)
    }

    /// Units that are none that is known: a slip, or a device that nobody here has thought of.
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

/// Whether they are one unit, however it is spaced and spelt.
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
