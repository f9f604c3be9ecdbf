//! What a stated tolerance may be is no finding; what it may not be is one.

mod made;

use gap::diagnosis::{Diagnosis, Verdict};
use gap::{Options, diagnose};
use made::{paddle, recording};
use recording::Model;

/// So long that a dozen windows weigh no more than the tolerances.
const HORIZON_S: f64 = 0.5;

/// Three numbers with tolerances, and a paddle with so many times the nominal damping.
fn diagnosed(damping: f64, tolerance: f64, seed: u64) -> Diagnosis {
    let model = Model {
        viscous: paddle().viscous * damping,
        ..paddle()
    };
    let mut recording = recording(&model, paddle(), 1e-4, 0.0, seed);
    for (name, tolerance) in [("inertia", 0.01), ("coulomb", 0.01), ("viscous", tolerance)] {
        recording.tolerance.set(name, tolerance);
    }
    recording.horizon = HORIZON_S;
    diagnose(&recording, &Options::default()).diagnosis
}

#[test]
fn a_number_within_three_of_its_deviations_is_no_finding() {
    for seed in 0..4 {
        let found = diagnosed(1.28, 0.1, seed);
        assert_eq!(found.verdict, Verdict::NoGap, "{seed}: {:?}", found.effects);
    }
}

#[test]
fn a_nominal_number_within_its_tolerance_of_the_true_one_is_no_finding() {
    let (tolerance, deviations) = (0.25, -2.0);
    let damping = 1.0 / (1.0 + tolerance * deviations);
    let found = diagnosed(damping, tolerance, 1);
    assert_eq!(found.verdict, Verdict::NoGap, "{:?}", found.effects);
}

#[test]
fn a_number_far_from_it_is_one() {
    let found = diagnosed(5.0, 0.1, 1);
    assert_eq!(found.verdict, Verdict::Explained);
    assert_eq!(found.effects[0].name, "viscous");
}

/// Names found in a paddle of more friction and of a number that lies four deviations from the nominal one, which leave no more
/// than noise together.
fn found_beside_friction(number: &str) -> Vec<&'static str> {
    const TOLERANCE: f64 = 0.03;
    let mut model = Model {
        coulomb: 1.5 * paddle().coulomb,
        ..paddle()
    };
    let nominal = model.get(number).unwrap();
    assert!(model.set(number, nominal * (1.0 + 4.0 * TOLERANCE)));
    let mut recording = recording(&model, paddle(), 1e-4, 0.0, 1);
    recording.tolerance.set(number, TOLERANCE);
    let diagnosis = diagnose(&recording, &Options::default()).diagnosis;
    assert_eq!(diagnosis.verdict, Verdict::Explained);
    let mut names: Vec<_> = diagnosis.effects.iter().map(|e| e.name).collect();
    names.sort_unstable();
    names
}

#[test]
fn a_number_that_goes_too_far_beside_an_effect_is_another_one() {
    assert_eq!(found_beside_friction("inertia"), ["coulomb", "inertia"]);
    assert_eq!(found_beside_friction("ratio"), ["coulomb", "torque_gain"]);
}

#[test]
fn friction_within_its_tolerance_that_holds_where_the_nominal_one_slides_is_no_finding() {
    for (tolerance, deviations, coulomb, horizon) in [
        (0.1, 2.5, 0.03, 0.3),
        (0.1, 1.75, 0.034, 0.6),
        (0.15, 1.75, 0.026, 0.15),
        (0.15, 2.25, 0.022, 0.15),
    ] {
        let nominal = Model {
            coulomb,
            ..paddle()
        };
        let model = Model {
            coulomb: coulomb * (1.0 + tolerance * deviations),
            ..nominal
        };
        let mut recording = recording(&model, nominal, 1e-4, 0.0, 1);
        recording.tolerance.set("coulomb", tolerance);
        recording.tolerance.set("inertia", 0.01);
        recording.horizon = horizon;
        let found = diagnose(&recording, &Options::default()).diagnosis;
        assert_eq!(
            found.verdict,
            Verdict::NoGap,
            "{coulomb}: {:?}",
            found.effects
        );
    }
}
