//! The effects, one file each, and the list of them.

mod asymmetric_coulomb;
mod backlash;
mod cogging;
mod compliance;
mod contact;
mod coulomb;
mod deadband;
mod delay;
mod description;
mod end_stop;
pub(crate) mod episode;
mod friction_drift;
mod gravity;
mod identification;
mod inertia;
mod input_nonlinearity;
mod lag;
mod load_dependent_friction;
mod lost_counts;
mod own;
mod phrase;
mod position_dependent_coulomb;
mod presliding;
mod push;
mod quadratic_drag;
mod rate_limit;
mod restoring;
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

pub use description::{Demonstration, Description, Multisine, descriptions};
pub(crate) use episode::Episode;
pub(crate) use identification::{Family, Fitted, Identification, Landscape};
pub use own::{OwnEffectError, add_own};
pub use phrase::{Nominal, Part, Phrase};

use crate::diagnosis::Finding;
use crate::guess::Evidence;
use crate::term::Term;
use host_sim::effects::{Channel, KINDS};
use phrase::Found;
use rayon::prelude::*;

/// Every effect of the library, in the order of the vocabulary.
static ALL: [&dyn Identification; KINDS.len()] = [
    &torque_gain::TorqueGain,
    &torque_offset::TorqueOffset,
    &deadband::Deadband,
    &saturation::Saturation,
    &input_nonlinearity::InputNonlinearity,
    &rate_limit::RateLimit,
    &lag::Lag,
    &delay::Delay,
    &cogging::Cogging,
    &coulomb::Coulomb,
    &asymmetric_coulomb::AsymmetricCoulomb,
    &position_dependent_coulomb::PositionDependentCoulomb,
    &stribeck::Stribeck,
    &viscous::Viscous,
    &quadratic_drag::QuadraticDrag,
    &presliding::Presliding,
    &load_dependent_friction::LoadDependentFriction,
    &friction_drift::FrictionDrift,
    &inertia::Inertia,
    &gravity::Gravity,
    &spring::Spring,
    &end_stop::EndStop,
    &backlash::Backlash,
    &compliance::Compliance,
    &sensor_gain::SensorGain,
    &sensor_nonlinearity::SensorNonlinearity,
    &sensor_hysteresis::SensorHysteresis,
    &sensor_lag::SensorLag,
    &lost_counts::LostCounts,
    &contact::Contact,
    &push::Push,
];

/// An effect with the starts of its fit.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub effect: &'static dyn Identification,
    pub starts: Vec<Term>,
}

/// Every effect that the recording may show, in the order of the vocabulary.
pub(crate) fn candidates(evidence: &Evidence<'_>) -> Vec<Candidate> {
    let all: Vec<&dyn Identification> = all().collect();
    let all = all.into_par_iter().map(|effect| Candidate {
        effect,
        starts: effect.starts(evidence),
    });
    all.filter(|candidate| !candidate.starts.is_empty())
        .collect()
}

/// The effect with the name `name`, if it exists.
pub(crate) fn find(name: &str) -> Option<&'static dyn Identification> {
    all().find(|effect| effect.name() == name)
}

/// The effect with the name `name`.
///
/// # Panics
///
/// If no effect has this name. The names within this crate are those of [`KINDS`] and of effects that were added, which all exist.
pub(crate) fn of(name: &str) -> &'static dyn Identification {
    find(name).expect("a name of the vocabulary")
}

/// All effects. Those that a user added come last.
pub(crate) fn all() -> impl Iterator<Item = &'static dyn Identification> {
    ALL.iter().copied().chain(own::all())
}

/// The effect that replaces a parameter of the model, if it exists.
pub(crate) fn replacing(number: &str) -> Option<&'static dyn Identification> {
    all().find(|effect| effect.replaces() == Some(number))
}

/// The effects of the sensing channel.
pub(crate) fn sensing() -> impl Iterator<Item = &'static dyn Identification> {
    all().filter(|effect| effect.kind().channel == Channel::Sensing)
}

/// The noun for the effect `name` in a sentence, without its parameters. Returns `name` if the effect does not exist.
pub fn noun(name: &str) -> &str {
    find(name).map_or(name, |effect| effect.noun())
}

/// The description of a finding, as words and numbers, for a recording of a `nominal` model.
pub fn phrase(finding: &Finding, nominal: &Nominal) -> Phrase {
    let found = Found { finding, nominal };
    find(finding.name).map_or_else(|| Phrase::of(finding.name), |effect| effect.phrase(&found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Estimate;

    #[test]
    fn effects_come_in_the_order_of_the_vocabulary() {
        let names: Vec<&str> = all().map(|effect| effect.name()).collect();
        let vocabulary: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        assert_eq!(names, vocabulary);
    }

    #[test]
    fn every_template_uses_existing_parameters() {
        let nominal = Nominal {
            coulomb: 0.0,
            input_limit: None,
            has_stops: false,
            has_runs: false,
        };
        for effect in all() {
            let parameters = effect.kind().parameters.iter().map(|p| {
                let estimate = Estimate {
                    value: 0.25,
                    std: Some(0.1),
                    unit: "1".into(),
                    is_fitted: true,
                };
                (p.name.to_owned(), estimate)
            });
            let finding = Finding {
                name: effect.name(),
                channel: "",
                confidence: 0.9,
                not_separable_from: Vec::new(),
                basis: "prediction",
                held_out: true,
                parameters: parameters.collect(),
                shrink: 0.5,
                shrink_interval: [0.4, 0.6],
            };
            let found = Found {
                finding: &finding,
                nominal: &nominal,
            };
            let template = effect.template(&found);
            let Phrase(parts) = found.filled(template).expect(template);
            let numbers = parts.iter().any(|part| matches!(part, Part::Number(_)));
            assert_eq!(numbers, template.contains('{'), "{template}");
        }
    }

    #[test]
    fn no_effect_is_its_own_special_case() {
        for effect in all() {
            assert!(!effect.contains(effect.name()), "{}", effect.name());
        }
    }
}
