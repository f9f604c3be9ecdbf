//! The effects that can be switched into a simulated device, one file each: equation, parameters,
//! typical range.

mod asymmetric_coulomb;
mod backlash;
mod cogging;
mod compliance;
mod contact;
mod coulomb;
mod deadband;
mod delay;
mod end_stop;
mod friction_drift;
mod gravity;
mod inertia;
mod lag;
mod load_dependent_friction;
mod lost_counts;
mod position_dependent_coulomb;
mod presliding;
mod quadratic_drag;
mod saturation;
mod sensor_gain;
mod sensor_hysteresis;
mod sensor_lag;
mod sensor_nonlinearity;
mod spring;
mod stribeck;
mod torque_gain;
mod torque_offset;
mod viscous;

use crate::device::Device;
use core::ops::Range;

/// Part of a device that an effect sits in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// From the input to the torque.
    Actuation,
    /// What resists motion.
    Friction,
    /// Inertia, elasticity, stops.
    Mechanics,
    /// From the position to its reading.
    Sensing,
    /// Outside the device.
    Surroundings,
}

impl Channel {
    /// The name in the recording contract.
    pub fn name(self) -> &'static str {
        match self {
            Self::Actuation => "actuation",
            Self::Friction => "friction",
            Self::Mechanics => "mechanics",
            Self::Sensing => "sensing",
            Self::Surroundings => "surroundings",
        }
    }
}

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A pure number.
    Ratio,
    /// A phase.
    Angle,
    /// s.
    Time,
    /// 1/s.
    Frequency,
    /// Unit of the input.
    Input,
    /// Unit of position.
    Position,
    /// 1/position.
    PerPosition,
    /// 1/position².
    PerPositionSquared,
    /// Position/s.
    Velocity,
    /// Joint torque.
    Torque,
    /// Torque/position.
    Stiffness,
    /// Torque s/position.
    Damping,
    /// Torque s²/position².
    Drag,
    /// Torque s²/position.
    Inertia,
}

impl Quantity {
    /// The unit for an axis whose position and input have these units.
    pub fn unit(self, position: &str, input: &str) -> String {
        let torque = if position == "m" || position == "mm" {
            "N"
        } else {
            "N m"
        };
        match self {
            Self::Ratio => "1".into(),
            Self::Angle => "rad".into(),
            Self::Time => "s".into(),
            Self::Frequency => "1/s".into(),
            Self::Input => input.into(),
            Self::Position => position.into(),
            Self::PerPosition => format!("1/{position}"),
            Self::PerPositionSquared => format!("1/{position}²"),
            Self::Velocity => format!("{position}/s"),
            Self::Torque => torque.into(),
            Self::Stiffness => format!("{torque}/{position}"),
            Self::Damping => format!("{torque} s/{position}"),
            Self::Drag => format!("{torque} s²/{position}²"),
            Self::Inertia => format!("{torque} s²/{position}"),
        }
    }
}

/// One number of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// As a user writes it.
    pub name: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Lowest and highest value that has a meaning.
    pub range: [f64; 2],
    /// What it is where a user does not say, for the paddle.
    pub default: f64,
    /// Typical range, for the paddle.
    pub typical: [f64; 2],
    /// What it means.
    pub about: &'static str,
}

/// A kind of effect.
#[derive(Debug)]
pub struct Kind {
    /// The name in the recording contract.
    pub name: &'static str,
    /// Where it sits.
    pub channel: Channel,
    /// In one sentence.
    pub about: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// Its numbers, in the order in which `install` takes them; values beyond them repeat some of them, where something
    /// happens more than once.
    pub parameters: &'static [Parameter],
    /// Puts it into a device, with numbers in their ranges.
    install: fn(&mut Device, &[f64]),
}

impl Kind {
    /// Puts it into a device. Numbers beyond their range are taken at its end.
    pub fn install(&self, device: &mut Device, values: &[f64]) {
        (self.install)(device, &self.held(values));
    }

    /// The numbers, those beyond their range at its end.
    pub fn held(&self, values: &[f64]) -> Vec<f64> {
        let values = values.iter().enumerate();
        let held = values.map(|(place, value)| {
            let [low, high] = self.parameter(place).range;
            value.max(low).min(high)
        });
        held.collect()
    }

    /// A number written as `name` for the value at `place`.
    ///
    /// # Errors
    /// [`EffectError::Range`] if it has no meaning there.
    pub fn checked(&self, place: usize, name: &str, value: f64) -> Result<f64, EffectError> {
        let [low, high] = self.parameter(place).range;
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(value);
        }
        let mend = match [low, high] {
            [f64::MIN_POSITIVE, f64::INFINITY] => "a number above 0".to_owned(),
            [f64::NEG_INFINITY, f64::INFINITY] => "a finite number".to_owned(),
            [low, f64::INFINITY] => format!("{low} or more"),
            [low, high] => format!("one from {low} to {high}"),
        };
        Err(EffectError::Range {
            kind: self.name,
            name: name.to_owned(),
            value,
            mend,
        })
    }

    /// The parameter of the value at `place`; there are more values than parameters where something happens more than once.
    pub fn parameter(&self, place: usize) -> &'static Parameter {
        let Range { start, end } = self.repeated();
        let again = |beyond: usize| start + beyond % (end - start).max(1);
        let beyond = place.checked_sub(self.parameters.len());
        &self.parameters[beyond.map_or(place, again)]
    }

    /// Name of the value at `place` of an effect of this kind that has `count` of them; what happens more than once is
    /// numbered from 1.
    pub fn value_name(&self, place: usize, count: usize) -> String {
        let once = self.parameters.len();
        let name = self.parameter(place).name;
        match place.checked_sub(once) {
            Some(beyond) => format!("{name}_{}", beyond / self.repeated().len().max(1) + 2),
            None if count > once && self.repeated().contains(&place) => format!("{name}_1"),
            None => name.to_owned(),
        }
    }

    /// Places of what is said of each time that it happens; none if it always does.
    fn repeated(&self) -> Range<usize> {
        match self.name {
            "contact" => contact::STAY,
            "lost_counts" => lost_counts::JUMP,
            _ => 0..0,
        }
    }

    /// How often something may happen.
    pub fn most_events(&self) -> usize {
        match self.name {
            "contact" => contact::MOST_STAYS,
            "lost_counts" => usize::MAX,
            _ => 1,
        }
    }

    /// Names of the values of an effect that happens as often as the numbers of those that are `wanted` say, which may be others.
    pub fn value_names(&self, wanted: &[&str]) -> Vec<String> {
        let number = |name: &&str| name.rsplit_once('_')?.1.parse().ok();
        let told = wanted.iter().filter_map(number).max().unwrap_or(1);
        // Of each time something must be said, so that no number is taken for more than there can be.
        let most = self.most_events().min(wanted.len()).max(1);
        let count = self.event_place(told.clamp(1, most));
        let places = 0..count;
        places.map(|place| self.value_name(place, count)).collect()
    }

    /// True if with these values it acts at moments of one session alone.
    pub fn is_event(&self, values: &[f64]) -> bool {
        match self.name {
            "contact" => true,
            "lost_counts" => values[lost_counts::SHARE_LOST] == 0.0,
            _ => false,
        }
    }

    /// When it acts with these values, s of the session; none if at all times.
    pub fn meanwhile(&self, values: &[f64]) -> Option<Vec<[f64; 2]>> {
        (self.name == "contact").then(|| contact::meanwhile(values))
    }

    /// Place of the first value of the event `index`.
    pub fn event_place(&self, index: usize) -> usize {
        match index.checked_sub(1) {
            Some(before) => self.parameters.len() + self.repeated().len() * before,
            None => self.repeated().start,
        }
    }

    /// The values of an effect that does nothing but happen so, each time with these values.
    pub fn events<const N: usize>(&self, events: &[[f64; N]]) -> Vec<f64> {
        let count = self.event_place(events.len().max(1));
        let mut values: Vec<f64> = (0..count).map(|i| self.parameter(i).default).collect();
        for (index, event) in events.iter().enumerate() {
            let place = self.event_place(index);
            values[place..place + N].copy_from_slice(event);
        }
        values
    }
}

/// Ranges of parameters.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const NOT_NEGATIVE: [f64; 2] = [0.0, f64::INFINITY];
const POSITIVE: [f64; 2] = [f64::MIN_POSITIVE, f64::INFINITY];
const SHARE: [f64; 2] = [0.0, 1.0];
/// Of the share of the inertia on either side of a transmission.
const INERTIA_SHARE: [f64; 2] = [0.01, 0.99];
/// Of the level of a dry friction that varies, over the model's.
const LEVEL: [f64; 2] = [0.01, f64::INFINITY];

/// Of a transmission between two masses.
const LOAD_FRICTION: Parameter = Parameter {
    name: "load_friction",
    quantity: Quantity::Ratio,
    range: SHARE,
    default: 0.0,
    typical: [0.0, 1.0],
    about: "share of the friction on the load side",
};
/// Of a [`Ripple`](crate::ripple::Ripple).
const WAVE_NUMBER: Parameter = Parameter {
    name: "wave_number",
    quantity: Quantity::PerPosition,
    range: POSITIVE,
    default: 6.0,
    typical: [1.0, 60.0],
    about: "2π over the period of the ripple",
};

/// All kinds, in the order of the contract's vocabulary.
pub const KINDS: &[&Kind] = &[
    &torque_gain::KIND,
    &torque_offset::KIND,
    &deadband::KIND,
    &saturation::KIND,
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
];

/// The kind called `name`.
pub fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().copied().find(|kind| kind.name == name)
}

/// An effect as a user asks for it.
#[derive(Clone, Debug)]
pub struct Effect {
    /// Its kind.
    pub kind: &'static Kind,
    /// Its numbers, in the order of the kind's parameters.
    pub values: Vec<f64>,
}

impl Effect {
    /// True if it acts at moments of one session.
    pub fn is_event(&self) -> bool {
        self.kind.is_event(&self.values)
    }

    /// Puts it into `device`.
    pub fn install(&self, device: &mut Device) {
        self.kind.install(device, &self.values);
    }
}

/// What is wrong with an effect as written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// No such kind.
    #[error("no effect is called '{0}'; `paddle effects` lists them")]
    Kind(String),
    /// No such parameter.
    #[error("effect '{kind}' has no parameter '{name}'; it has {known}")]
    Parameter {
        /// The kind.
        kind: &'static str,
        /// As written.
        name: String,
        /// Those it has.
        known: String,
    },
    /// Not a finite number.
    #[error("'{0}' is no number; write an effect as name:parameter=value,parameter=value")]
    Value(String),
    /// A number that has no meaning there.
    #[error("{kind} cannot have {name} = {value}; write {mend}")]
    Range {
        /// The kind.
        kind: &'static str,
        /// Of the parameter, as written.
        name: String,
        /// As written.
        value: f64,
        /// What has a meaning.
        mend: String,
    },
}

impl core::str::FromStr for Effect {
    type Err = EffectError;

    /// Reads `name` or `name:parameter=value,parameter=value`; what is left out takes its default. What happens more than once
    /// is numbered: `contact:from_1=2,to_1=3,from_2=6,to_2=7`.
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
    fn static_friction_below_the_sliding_level_is_none() {
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
    fn what_happens_more_than_once_is_numbered() {
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
