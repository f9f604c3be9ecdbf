//! The description of an effect for its page in the documentation, gathered from its definition.

use super::identification::Identification;
use super::{ALL, all};
use crate::missing_torque::Axis;
use host_sim::effects::Kind;

/// An experiment in which the simulated paddle shows an effect on its page in the documentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demonstration {
    /// The excitation of the paddle.
    pub multisine: Multisine,
    /// Parameters of the effect that differ from their defaults, by name, in the units of the paddle.
    pub numbers: &'static [(&'static str, f64)],
}

/// An excitation by a sum of six harmonics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Multisine {
    /// A setpoint of the position controller.
    Position {
        /// Largest position, °.
        amplitude_deg: f64,
        /// Frequency of the fundamental, Hz.
        frequency_hz: f64,
    },
    /// A motor torque without a controller.
    Torque {
        /// Largest torque, N m.
        amplitude_nm: f64,
        /// Frequency of the fundamental, Hz.
        frequency_hz: f64,
    },
}

impl Demonstration {
    /// The experiment for most effects, at their default parameters.
    pub(super) const USUAL: Self = Self {
        multisine: Multisine::Position {
            amplitude_deg: 15.0,
            frequency_hz: 0.5,
        },
        numbers: &[],
    };
}

/// An effect as its page in the documentation describes it. Other effects are given by their names.
#[derive(Clone, Debug)]
pub struct Description {
    /// Equation, parameters, bounds and typical values.
    pub kind: &'static Kind,
    /// The noun for the effect in a sentence, without its parameters.
    pub noun: &'static str,
    /// The axis along which the torque of the effect is most visible.
    pub axis: Axis,
    /// Effects that equal this one for certain values of its parameters.
    pub special_cases: Vec<&'static str>,
    /// Effects that this one equals for certain values of their parameters.
    pub special_case_of: Vec<&'static str>,
    /// Simpler effects that are named instead if they explain nearly as much.
    pub simpler_substitutes: Vec<&'static str>,
    /// Effects that cannot be distinguished from this one on small, slow motion.
    pub near_equivalents: Vec<&'static str>,
    /// The evidence that distinguishes the effect from similar ones, and a recording that shows it.
    pub tell_apart: &'static str,
    /// The experiment that demonstrates the effect.
    pub demonstration: Demonstration,
}

/// All effects of the library, in the order of the vocabulary.
pub fn descriptions() -> impl Iterator<Item = Description> {
    ALL.iter().map(|effect| Description::of(*effect))
}

impl Description {
    fn of(effect: &'static dyn Identification) -> Self {
        let name = effect.name();
        let family = effect.family();
        let names = |effects: &[&'static dyn Identification]| {
            effects.iter().map(|effect| effect.name()).collect()
        };
        let containing = all().filter(|other| other.contains(name));
        let near = all()
            .filter(|other| other.name() != name && family.is_some() && other.family() == family);
        Self {
            kind: effect.kind(),
            noun: effect.noun(),
            axis: effect.axis(),
            special_cases: names(effect.special_cases()),
            special_case_of: containing.map(|other| other.name()).collect(),
            simpler_substitutes: names(effect.simpler_substitutes()),
            near_equivalents: near.map(|other| other.name()).collect(),
            tell_apart: effect.tell_apart(),
            demonstration: effect.demonstration(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_equivalents_and_special_cases_are_mutual() {
        let all: Vec<Description> = descriptions().collect();
        let of = |name: &str| all.iter().find(|other| other.kind.name == name).unwrap();
        for one in &all {
            let name = one.kind.name;
            assert!(!one.tell_apart.is_empty(), "{name}");
            assert!(!one.kind.sizes_from.is_empty(), "{name}");
            for near in &one.near_equivalents {
                assert!(of(near).near_equivalents.contains(&name), "{name}, {near}");
            }
            for special in &one.special_cases {
                let of_special = &of(special).special_case_of;
                assert!(of_special.contains(&name), "{name}, {special}");
            }
        }
        assert_eq!(of("stribeck").special_cases, ["coulomb"]);
    }
}
