//! The effects that can be added to a simulated device, one file each, with equation, parameters and typical ranges.

pub mod asymmetric_coulomb;
pub mod backlash;
pub mod cogging;
pub mod compliance;
pub mod contact;
pub mod coulomb;
pub mod deadband;
pub mod delay;
pub mod end_stop;
pub mod friction_drift;
pub mod gravity;
pub mod inertia;
pub mod input_nonlinearity;
mod kind;
pub mod lag;
pub mod load_dependent_friction;
pub mod lost_counts;
pub mod own;
pub mod position_dependent_coulomb;
pub mod presliding;
pub mod push;
pub mod quadratic_drag;
mod quantity;
pub mod rate_limit;
pub mod saturation;
pub mod sensor_gain;
pub mod sensor_hysteresis;
pub mod sensor_lag;
pub mod sensor_nonlinearity;
pub mod spring;
pub mod stribeck;
pub mod torque_gain;
pub mod torque_offset;
pub mod viscous;

use crate::device::Device;
use kind::{Events, PLAIN};

pub use kind::{Channel, Kind};
pub use quantity::{Parameter, Quantity};

/// Ranges of parameters.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const NOT_NEGATIVE: [f64; 2] = [0.0, f64::INFINITY];
const POSITIVE: [f64; 2] = [f64::MIN_POSITIVE, f64::INFINITY];
const SHARE: [f64; 2] = [0.0, 1.0];
/// Range of the share of the inertia on the load side of a transmission.
const INERTIA_SHARE: [f64; 2] = [0.01, 0.99];
/// Range of a level of dry friction, relative to the model's.
const LEVEL: [f64; 2] = [0.01, f64::INFINITY];

/// A parameter that is a share or a switch, with the default 0.
const fn share(name: &'static str, about: &'static str) -> Parameter {
    Parameter {
        name,
        quantity: Quantity::Ratio,
        range: SHARE,
        default: 0.0,
        typical: [0.0, 1.0],
        about,
    }
}

/// A parameter for a position, with the default 0.
const fn zero(about: &'static str) -> Parameter {
    Parameter {
        name: "zero",
        quantity: Quantity::Position,
        range: ANY,
        default: 0.0,
        typical: [-0.3, 0.3],
        about,
    }
}

/// A parameter for the start or the end of an event.
const fn instant(name: &'static str, default: f64) -> Parameter {
    Parameter {
        name,
        quantity: Quantity::Time,
        range: ANY,
        default,
        typical: [0.0, 1000.0],
        about: "time of the session",
    }
}

/// Share of the friction on the load side of a transmission between two masses.
const LOAD_FRICTION: Parameter = share("load_friction", "share of the friction on the load side");
/// Wave number of a [`Ripple`](crate::ripple::Ripple).
const WAVE_NUMBER: Parameter = Parameter {
    name: "wave_number",
    quantity: Quantity::PerPosition,
    range: POSITIVE,
    default: 6.0,
    typical: [1.0, 60.0],
    about: "2π over the period of the ripple",
};

/// All kinds, in the order of the contract.
pub const KINDS: &[&Kind] = &[
    &torque_gain::KIND,
    &torque_offset::KIND,
    &deadband::KIND,
    &saturation::KIND,
    &input_nonlinearity::KIND,
    &rate_limit::KIND,
    &lag::KIND,
    &delay::KIND,
    &cogging::KIND,
    &coulomb::KIND,
    &asymmetric_coulomb::KIND,
    &position_dependent_coulomb::KIND,
    &stribeck::KIND,
    &viscous::KIND,
    &quadratic_drag::KIND,
    &presliding::KIND,
    &load_dependent_friction::KIND,
    &friction_drift::KIND,
    &inertia::KIND,
    &gravity::KIND,
    &spring::KIND,
    &end_stop::KIND,
    &backlash::KIND,
    &compliance::KIND,
    &sensor_gain::KIND,
    &sensor_nonlinearity::KIND,
    &sensor_hysteresis::KIND,
    &sensor_lag::KIND,
    &lost_counts::KIND,
    &contact::KIND,
    &push::KIND,
];

/// Finds the kind called `name`.
pub fn kind(name: &str) -> Option<&'static Kind> {
    let built_in = KINDS.iter().copied().find(|kind| kind.name == name);
    built_in.or_else(|| own::find(name))
}

/// An effect with its values.
#[derive(Clone, Debug)]
pub struct Effect {
    /// Its kind.
    pub kind: &'static Kind,
    /// Its values, in the order of the kind's parameters.
    pub values: Vec<f64>,
}

impl Effect {
    /// True if it acts only during events of one session.
    pub fn is_event(&self) -> bool {
        self.kind.is_event(&self.values)
    }

    /// Applies it to `device`.
    pub fn install(&self, device: &mut Device) {
        self.kind.install(device, &self.values);
    }
}

/// Checks that no two effects have the same kind. Each effect sets parameters of the device, so the second would replace the
/// first.
///
/// # Errors
///
/// [`EffectError::Twice`].
pub fn check_distinct<'a>(
    effects: impl IntoIterator<Item = &'a Effect>,
) -> Result<(), EffectError> {
    let mut seen: Vec<&str> = Vec::new();
    for effect in effects {
        let name = effect.kind.name;
        if seen.contains(&name) {
            return Err(EffectError::Twice(name));
        }
        seen.push(name);
    }
    Ok(())
}

/// Why the text of an effect is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// No kind has this name.
    #[error("no effect is called '{0}'; `paddle effects` lists them")]
    Kind(String),
    /// The kind has no parameter with this name.
    #[error("effect '{kind}' has no parameter '{name}'; it has {known}")]
    Parameter {
        /// The kind.
        kind: &'static str,
        /// The name as written.
        name: String,
        /// The parameters that the kind has.
        known: String,
    },
    /// Two effects of the same kind.
    #[error("effect '{0}' is there twice; write it once, with all its parameters")]
    Twice(&'static str),
    /// A parameter is written twice.
    #[error("{kind} has {name} twice; write it once")]
    ParameterTwice {
        /// The kind.
        kind: &'static str,
        /// Name of the parameter as written.
        name: String,
    },
    /// The value is not a finite number.
    #[error("'{0}' is no number; write an effect as name:parameter=value,parameter=value")]
    Value(String),
    /// The value is outside the allowed range.
    #[error("{kind} cannot have {name} = {value}; write {mend}")]
    Range {
        /// The kind.
        kind: &'static str,
        /// Name of the parameter as written.
        name: String,
        /// The value as written.
        value: f64,
        /// The allowed values.
        mend: String,
    },
}

impl core::str::FromStr for Effect {
    type Err = EffectError;

    /// Parses `name` or `name:parameter=value,parameter=value`. Missing parameters take their defaults. Parameters of
    /// repeated events are numbered: `contact:from_1=2,to_1=3,from_2=6,to_2=7`.
    fn from_str(text: &str) -> Result<Self, EffectError> {
        let (name, settings) = text.split_once(':').unwrap_or((text, ""));
        let kind = kind(name).ok_or_else(|| EffectError::Kind(name.into()))?;
        let settings = settings.split(',').filter(|s| !s.is_empty());
        let settings = settings.map(|setting| {
            let pair = setting.split_once('=');
            pair.ok_or_else(|| EffectError::Value(setting.into()))
        });
        let settings: Vec<(&str, &str)> = settings.collect::<Result<_, _>>()?;
        let wanted: Vec<&str> = settings.iter().map(|(name, _)| *name).collect();
        let twice =
            |(at, name): (usize, &&str)| wanted[..at].contains(name).then(|| name.to_string());
        if let Some(name) = wanted.iter().enumerate().find_map(twice) {
            let kind = kind.name;
            return Err(EffectError::ParameterTwice { kind, name });
        }
        let names = kind.value_names(&wanted);
        let places = 0..names.len();
        let mut values: Vec<f64> = places.map(|i| kind.parameter(i).default).collect();
        for (name, value) in settings {
            let at = names
                .iter()
                .position(|known| known == name)
                .ok_or_else(|| EffectError::Parameter {
                    kind: kind.name,
                    name: name.into(),
                    known: names.join(", "),
                })?;
            let value = value
                .parse()
                .map_err(|_| EffectError::Value(value.into()))?;
            values[at] = kind.checked(at, name, value)?;
        }
        Ok(Self { kind, values })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::Model;

    #[test]
    fn static_friction_below_the_sliding_level_is_refused() {
        let written = "stribeck:static_ratio=0.9".parse::<Effect>();
        let refused = written.unwrap_err().to_string();
        assert_eq!(
            refused,
            "stribeck cannot have static_ratio = 0.9; write 1 or more"
        );
        assert!("stribeck:static_ratio=1".parse::<Effect>().is_ok());
        let mut device = Device::nominal(&Model::new(1e-3));
        kind("stribeck")
            .unwrap()
            .install(&mut device, &[0.9, 0.1, 2.0, 0.0]);
        assert!(device.mechanics.friction.stribeck.is_none());
    }

    #[test]
    fn values_of_repeated_events_are_in_the_order_of_their_definition_and_number() {
        let names = kind("contact").unwrap().value_names(&["from_1", "from_2"]);
        let expected = [
            "stiffness",
            "damping",
            "side_1",
            "position_1",
            "from_1",
            "to_1",
            "side_2",
            "position_2",
            "from_2",
            "to_2",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn a_repeated_parameter_or_effect_is_refused() {
        let twice = "stribeck:static_ratio=1.2,static_ratio=1.4".parse::<Effect>();
        let said = twice.unwrap_err().to_string();
        assert_eq!(said, "stribeck has static_ratio twice; write it once");
        let [one, two, other] =
            ["lag", "lag:time=0.1", "delay"].map(|text| text.parse::<Effect>().unwrap());
        assert_eq!(check_distinct([&one, &other]), Ok(()));
        assert_eq!(
            check_distinct([&one, &other, &two]),
            Err(EffectError::Twice("lag"))
        );
    }

    #[test]
    fn parameters_of_repeated_events_are_numbered() {
        let values = |text: &str| text.parse::<Effect>().map(|effect| effect.values);
        let twice = values("contact:side_1=0,from_1=1,to_1=2,position_2=3,from_2=5,to_2=6");
        let twice = twice.unwrap();
        assert_eq!(&twice[2..6], [0.0, 0.1, 1.0, 2.0]);
        assert_eq!(&twice[6..], [1.0, 3.0, 5.0, 6.0]);
        let jumps = values("lost_counts:time_1=1,jump_1=0.1,jump_2=0.2,time_2=3").unwrap();
        assert_eq!(jumps, [1.0, 0.1, 0.0, 0.0, 3.0, 0.2]);
        assert!(values("coulomb:level_2=1").is_err());
        assert!(values("contact:from_5=1").is_err());
        assert!(values("contact:from_1=2,to_1=3").is_err());
    }
}
