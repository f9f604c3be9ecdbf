//! Finds effects that change a small and slow motion in nearly the same way. Each is fitted from the parameters of another one.

use super::rival::Rival;
use crate::effects;
use crate::term::Term;
use recording::Model;

fn is_near_equivalent(one: &str, other: &str) -> bool {
    let family = effects::of(one).family();
    one != other && family.is_some() && family == effects::of(other).family()
}

/// Returns the special cases and the near-equivalents of the rival `to` among `all`. Their fits begin at the values of that rival: the
/// model parameters, the effects before the last one, and the parameters that both last effects have in common.
pub(super) fn near_equivalents(to: &Rival, all: &[Rival], model: &Model) -> Vec<Rival> {
    let Some((held, (_, known))) = to.held().zip(to.fit.hypothesis.terms.split_last()) else {
        return Vec::new();
    };
    let beside = |terms: &[Term]| -> Vec<&str> { terms.iter().map(|t| t.kind.name).collect() };
    let moved = all.iter().filter_map(|rival| {
        let is_special = effects::of(to.name).gives_way_to(rival.name);
        // Without other effects a near-equivalent is fitted well from its own starts.
        let is_near_equivalent = is_near_equivalent(rival.name, to.name) && !known.is_empty();
        let (own, (last, others)) = rival.held().zip(rival.fit.hypothesis.terms.split_last())?;
        let is_related = (is_special || is_near_equivalent) && beside(others) == beside(known);
        is_related.then(|| {
            let mut rival = rival.clone();
            rival.fit.x = [&to.fit.x[..held], &rival.fit.x[own..]].concat();
            rival.fit.hypothesis.terms = [known, std::slice::from_ref(last)].concat();
            rival
        })
    });
    let started = moved.flat_map(|rival| {
        let shared = rival.starting_like(to, Term::alike);
        let equal = rival.starting_like(to, |own, other| equal(own, other, model));
        [Some(rival), shared, equal]
    });
    started.flatten().collect()
}

/// Returns a start of `own` with the same action on small motion as `other`. Returns `None` if there is no such start.
fn equal(own: &Term, other: &Term, model: &Model) -> Option<Term> {
    let motion = effects::of(other.kind.name).on_small_motion(other, model)?;
    effects::of(own.kind.name).equivalent_start(own, motion, model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Fit;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::Hypothesis;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    /// An effect with start values `values`, all of them free.
    fn term(name: &str, values: &[f64]) -> Term {
        let coordinate = |(parameter, &start)| Coordinate {
            parameter,
            start,
            scale: Scale::Linear(1.0),
        };
        let free: Vec<Coordinate> = values.iter().enumerate().map(coordinate).collect();
        made::term(name, &free)
    }

    /// A rival with the effects `known` and one more effect.
    fn rival(known: &[Term], last: Term) -> Rival {
        let name = last.kind.name;
        let hypothesis = Hypothesis {
            terms: [known, &[last]].concat(),
        };
        let x = vec![0.0; hypothesis.free()];
        let costs = Costs {
            per_sample: Vec::new(),
            prior: 0.0,
        };
        let fit = Fit {
            std: x.clone(),
            hypothesis,
            x,
            costs,
        };
        Rival { name, fit }
    }

    /// Names of the near-equivalents of gravity that are tried beside the effects `known`.
    fn beside_gravity(known: &[Term]) -> Vec<&'static str> {
        let all = ["gravity", "spring", "inertia"];
        let all = all.map(|name| rival(known, term(name, &[0.1])));
        let found = near_equivalents(&all[0], &all, &Model::new(1.0));
        found.iter().map(|rival| rival.name).collect()
    }

    #[test]
    fn a_near_equivalent_is_tried_only_together_with_other_effects() {
        assert!(beside_gravity(&[]).is_empty());
        let found = beside_gravity(&[term("compliance", &[])]);
        assert!(!found.is_empty() && found.iter().all(|name| *name == "spring"));
    }

    /// Torque of gravity and spring near the position at which it is zero.
    fn restoring(model: &Model, x: f64) -> f64 {
        model.gravity * (x - model.gravity_zero) + model.stiffness * (x - model.stiffness_zero)
    }

    #[test]
    fn a_near_equivalent_starts_with_equal_action_on_small_motion() {
        let nominal = Model {
            gravity: 0.02,
            gravity_zero: 0.3,
            stiffness: 0.05,
            stiffness_zero: -0.1,
            ..Model::new(0.001)
        };
        let spring = term("spring", &[0.08, 0.2]);
        let weight = equal(&term("gravity", &[0.5, 0.0]), &spring, &nominal).unwrap();
        let sprung = Model {
            stiffness: 0.08,
            stiffness_zero: 0.2,
            ..nominal
        };
        let heavy = Model {
            gravity: weight.values[0],
            gravity_zero: weight.values[1],
            ..nominal
        };
        for x in [-0.2, 0.0, 0.5] {
            let torques = [&sprung, &heavy].map(|model| restoring(model, x));
            assert!((torques[0] - torques[1]).abs() < 1e-12, "{torques:?}");
        }
        let gain = equal(
            &term("torque_gain", &[1.0]),
            &term("inertia", &[0.002]),
            &nominal,
        );
        assert_eq!(gain.unwrap().values, [0.5]);
    }

    #[test]
    fn a_sensor_lag_is_a_second_lag_if_the_model_has_one() {
        let behind = |lag| {
            let model = Model {
                lag,
                ..Model::new(1.0)
            };
            let [own, other] = [("lag", 0.1), ("sensor_lag", 0.003)];
            let own = made::term(own.0, &[]).starting_at(&[(0, own.1)]);
            equal(&own, &term(other.0, &[other.1]), &model)
        };
        assert_eq!(behind(0.002).unwrap().values, [0.003, 1.0, 0.0]);
        assert!(behind(0.0).is_none());
    }

    #[test]
    fn a_weight_with_a_negative_slope_is_not_tried() {
        let nominal = Model {
            stiffness: 0.05,
            ..Model::new(0.001)
        };
        let soft = term("spring", &[0.04, 0.0]);
        assert!(equal(&term("gravity", &[0.1, 0.0]), &soft, &nominal).is_none());
    }

    #[test]
    fn a_constant_torque_starts_an_asymmetric_friction() {
        let model = Model {
            coulomb: 0.01,
            ..Model::new(1.0)
        };
        let sided = term("asymmetric_coulomb", &[0.01, 0.01]);
        let pushed = |torque| equal(&sided, &term("torque_offset", &[torque]), &model);
        let levels = pushed(0.004).unwrap().values;
        assert!((levels[0] - 0.006).abs() < 1e-12 && (levels[1] - 0.014).abs() < 1e-12);
        assert!(pushed(0.02).is_none());
    }
}
