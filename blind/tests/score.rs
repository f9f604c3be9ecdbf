//! Tests the scorer with truths and diagnoses written by hand.

use blind::score::{FreshGaps, Gaps, Outcome, Summary, judge};
use blind::{Diagnosis, Effect, Kind, Place, Reference, Truth};
use serde_json::json;

fn truth(kind: Kind, names: &[&str]) -> Truth {
    Truth {
        seed: 1,
        case: 1,
        kind,
        device: String::new(),
        effects: names
            .iter()
            .map(|name| Effect {
                name: (*name).into(),
                strength: 1.0,
                form: String::new(),
                places: vec![Place::on("velocity", -0.1, 0.1), Place::in_run(1, 2.0, 3.0)],
                share: None,
            })
            .collect(),
        reference: Reference {
            before: 1.0,
            after: 0.1,
            hidden_alone: 1.0,
            tolerances_alone: 0.0,
        },
        fresh_floor: Some(0.2),
        transfer_floor: None,
        timing: None,
    }
}

/// A diagnosis with these names, confidences and inseparable names.
fn says(verdict: &str, names: &[(&str, f64, &[&str])]) -> Diagnosis {
    let effects: Vec<_> = names
        .iter()
        .map(|(name, confidence, class)| {
            json!({"name": name, "channel": "friction", "confidence": confidence, "not_separable_from": class})
        })
        .collect();
    serde_json::from_value(json!({
        "format": 1,
        "verdict": verdict,
        "gap": {"before": 1.0, "floor": 0.1, "after": 0.19, "shrink": 0.9, "unit": "rad"},
        "effects": effects,
        "where": [],
        "elapsed_s": 1.5,
    }))
    .unwrap()
}

fn with_region(mut diagnosis: Diagnosis, regions: serde_json::Value) -> Diagnosis {
    diagnosis.regions = serde_json::from_value(regions).unwrap();
    diagnosis
}

fn plain(truth: &Truth, diagnosis: &Diagnosis) -> Outcome {
    judge(truth, Some(diagnosis), Gaps::default(), None)
}

#[test]
fn a_single_effect_counts_as_first_or_as_not_separable() {
    let truth = truth(Kind::Single, &["stribeck"]);
    let first = plain(
        &truth,
        &says("explained", &[("stribeck", 0.9, &["presliding"])]),
    );
    assert!(first.first && first.in_class && first.right && first.names == 2);
    let class = plain(
        &truth,
        &says("explained", &[("presliding", 0.9, &["stribeck"])]),
    );
    assert!(!class.first && class.in_class && !class.right);
    let missed = plain(&truth, &says("explained", &[("viscous", 0.9, &[])]));
    assert!(!missed.first && !missed.in_class);
    let silent = plain(&truth, &says("unexplained", &[]));
    assert!(!silent.right && silent.answer == "unexplained" && silent.names == 0);
}

#[test]
fn both_effects_of_a_pair_must_be_named_themselves() {
    let truth = truth(Kind::Pair, &["stribeck", "lag"]);
    let both = says("explained", &[("lag", 0.9, &[]), ("stribeck", 0.9, &[])]);
    assert!(plain(&truth, &both).right);
    let class = says("explained", &[("lag", 0.9, &["stribeck"])]);
    assert!(!plain(&truth, &class).right && plain(&truth, &class).in_class);
}

#[test]
fn a_case_without_a_cause_needs_the_verdict_no_gap() {
    let truth = truth(Kind::Nothing, &[]);
    assert!(plain(&truth, &says("no_gap", &[])).right);
    assert!(!plain(&truth, &says("unexplained", &[])).right);
}

#[test]
fn a_confident_name_is_wrong_for_a_cause_outside_the_vocabulary() {
    let truth = truth(Kind::Outside, &["torque_noise"]);
    for (verdict, names, right) in [
        ("unexplained", &[][..], true),
        ("partly_explained", &[("lag", 0.6, &[][..])], true),
        ("partly_explained", &[("lag", 0.95, &[])], false),
        ("explained", &[("lag", 0.6, &[])], false),
        ("no_gap", &[], false),
    ] {
        assert_eq!(
            plain(&truth, &says(verdict, names)).right,
            right,
            "{verdict} {names:?}"
        );
    }
}

#[test]
fn a_withheld_effect_counts_as_outside_the_vocabulary() {
    let truth = truth(Kind::Single, &["lag"]);
    let named = says("explained", &[("delay", 0.95, &[])]);
    let outcome = judge(&truth, Some(&named), Gaps::default(), Some("lag"));
    assert_eq!((outcome.kind, outcome.right), (Kind::Outside, false));
    let honest = judge(
        &truth,
        Some(&says("unexplained", &[])),
        Gaps::default(),
        Some("lag"),
    );
    assert!(honest.right);
}

#[test]
fn a_region_must_match_the_axis_and_run_of_a_place_and_overlap_it() {
    let truth = truth(Kind::Single, &["contact"]);
    let said = |regions| plain(&truth, &with_region(says("unexplained", &[]), regions)).place;
    let velocity = |from: f64, to: f64| json!({"axis": "velocity", "from": from, "to": to});
    let time = |run: serde_json::Value| json!({"axis": "time", "from": 2.5, "to": 4.0, "run": run});
    assert_eq!(said(json!([velocity(0.05, 0.3)])), Some(true));
    assert_eq!(said(json!([velocity(0.2, 0.3)])), Some(false));
    assert_eq!(
        said(json!([{"axis": "position", "from": -1.0, "to": 1.0}])),
        Some(false)
    );
    assert_eq!(said(json!([time(json!(1))])), Some(true));
    assert_eq!(said(json!([time(json!("run-2.csv"))])), Some(true));
    assert_eq!(said(json!([time(json!(0))])), Some(false));
    let away = velocity(5.0, 6.0);
    assert_eq!(
        said(json!([away, away, away, velocity(0.0, 0.1)])),
        Some(false),
        "the fourth is too late"
    );
}

#[test]
fn a_claimed_shrink_is_compared_with_the_fresh_recording() {
    let truth = truth(Kind::Single, &["lag"]);
    let said = says("explained", &[("lag", 0.9, &[])]);
    let fresh = Gaps {
        fresh: Some(FreshGaps {
            nominal: 2.0,
            corrected: 0.65,
        }),
        transfer: None,
    };
    let outcome = judge(&truth, Some(&said), fresh, None);
    // The gap falls from 2 to 0.65. The true model leaves 0.2.
    assert!((outcome.claim_error.unwrap() - (0.9 - 0.75)).abs() < 1e-12);
    // The true model reduces the gap from 1 to 0.1, the diagnosis to 0.19.
    assert!((outcome.relative_shrink.unwrap() - 0.9).abs() < 1e-12);
    assert_eq!(
        judge(&truth, Some(&said), Gaps::default(), None).claim_error,
        None
    );
}

#[test]
fn the_summary_counts_by_kind_and_compares_confidences() {
    let single = truth(Kind::Single, &["lag"]);
    let nothing = truth(Kind::Nothing, &[]);
    let outcomes = vec![
        plain(&single, &says("explained", &[("lag", 0.92, &[])])),
        plain(&single, &says("explained", &[("delay", 0.97, &["lag"])])),
        plain(&single, &says("explained", &[("lag", 0.75, &["delay"])])),
        judge(&single, None, Gaps::default(), None),
        plain(&nothing, &says("no_gap", &[])),
    ];
    let summary = Summary::of(outcomes);
    let row = |what: &str| summary.rows.iter().find(|row| row.what == what).unwrap();
    assert_eq!(row("first name is the true one").measured, Some(0.5));
    assert_eq!(row("true one named or not separable").measured, Some(0.75));
    assert_eq!(row("names given on average").measured, Some(1.25));
    assert_eq!(row("nothing wrong: no_gap").measured, Some(1.0));
    assert_eq!(row("two effects: both named").met(), None);
    assert_eq!(summary.confusion["lag"]["lag"], 2);
    assert_eq!(summary.confusion["lag"]["failed"], 1);
    let confident = &summary.calibration.confident;
    assert_eq!((confident.given, confident.right), (2, 1));
    let binned: usize = summary.calibration.bins.iter().map(|bin| bin.given).sum();
    assert_eq!(binned, 3);
}

/// A messy truth: lag dominates. Also present are a wrong stated `coulomb`, cogging, and a cause outside the vocabulary.
fn messy() -> Truth {
    truth(Kind::Messy, &["lag", "coulomb", "cogging", "torque_tone"])
}

fn with_numbers(mut diagnosis: Diagnosis, numbers: serde_json::Value) -> Diagnosis {
    diagnosis.numbers = serde_json::from_value(numbers).unwrap();
    diagnosis
}

#[test]
fn in_a_messy_case_the_dominant_cause_comes_first_or_is_called_not_separable() {
    let first = plain(&messy(), &says("explained", &[("lag", 0.9, &[])]));
    assert!(first.first && first.in_class && first.right);
    let class = plain(&messy(), &says("explained", &[("delay", 0.5, &["lag"])]));
    assert!(!class.first && class.in_class && !class.right);
    let later = says("explained", &[("cogging", 0.9, &[]), ("lag", 0.9, &[])]);
    let later = plain(&messy(), &later);
    assert!(!later.first && later.in_class, "named, but not first");
}

#[test]
fn in_a_messy_case_only_sure_names_that_are_no_hidden_cause_are_wrong() {
    let said = says(
        "partly_explained",
        &[
            ("lag", 0.9, &["sensor_lag"]),
            ("coulomb", 0.8, &[]),
            ("cogging", 0.7, &[]),
            ("viscous", 0.69, &[]),
            ("spring", 0.7, &[]),
        ],
    );
    let outcome = plain(&messy(), &said);
    assert_eq!(outcome.sure_names, 4);
    assert_eq!(outcome.not_there, ["spring"]);
}

#[test]
fn a_changed_number_is_no_name_but_finds_the_wrong_number() {
    let wrong = with_numbers(
        says("explained", &[("lag", 0.9, &[])]),
        json!([{"name": "viscous", "stated": 1.0, "found": 2.0, "shrink": 0.2}]),
    );
    let outcome = plain(&messy(), &wrong);
    assert!(outcome.first && outcome.not_there.is_empty(), "{outcome:?}");

    let off = truth(Kind::Messy, &["spring", "lag"]);
    let stiffness = json!([{"name": "stiffness", "shrink": 0.6}]);
    let alone = plain(&off, &with_numbers(says("no_gap", &[]), stiffness.clone()));
    assert!(alone.first && alone.in_class && !alone.silent);
    let mut beside = with_numbers(says("explained", &[("lag", 0.9, &[])]), stiffness);
    beside.effects[0].shrink = Some(0.7);
    assert!(!plain(&off, &beside).first, "the effect closes more");
    beside.effects[0].shrink = Some(0.5);
    assert!(plain(&off, &beside).first, "the number closes more");
}

#[test]
fn a_dominant_cause_outside_the_vocabulary_needs_an_answer_without_a_wrong_sure_name() {
    let outside = truth(Kind::Messy, &["torque_tone", "lag"]);
    let small = plain(&outside, &says("partly_explained", &[("lag", 0.9, &[])]));
    assert!(small.right && !small.first, "a small one is there");
    let unsure = plain(&outside, &says("explained", &[("spring", 0.6, &[])]));
    assert!(unsure.right);
    let sure = plain(&outside, &says("explained", &[("spring", 0.8, &[])]));
    assert!(!sure.right);
}

#[test]
fn the_messy_rows_count_cases_names_and_empty_answers() {
    let outside = truth(Kind::Messy, &["torque_tone", "lag"]);
    let outcomes = vec![
        plain(&messy(), &says("explained", &[("lag", 0.9, &[])])),
        plain(
            &messy(),
            &says(
                "explained",
                &[("spring", 0.8, &["lag"]), ("gravity", 0.9, &[])],
            ),
        ),
        plain(&messy(), &says("unexplained", &[])),
        judge(&messy(), None, Gaps::default(), None),
        plain(&outside, &says("unexplained", &[])),
    ];
    let summary = Summary::of(outcomes);
    let row = |what: &str| {
        let row = summary.rows.iter().find(|row| row.what.contains(what));
        row.unwrap_or_else(|| panic!("no row {what}: {summary}"))
    };
    let first = row("first finding is the dominant cause");
    assert_eq!((first.measured, first.cases), (Some(0.25), 4));
    assert_eq!(row("dominant named or not separable").measured, Some(0.5));
    assert_eq!(row("cases with a name >= 0.7").measured, Some(0.2));
    let names = row("names >= 0.7 that are not there");
    assert_eq!((names.measured, names.cases), (Some(2.0 / 3.0), 3));
    assert_eq!(row("outside vocabulary").measured, Some(1.0));
    assert_eq!(row("nothing found").measured, Some(0.25));
    let clean = |row: &blind::score::Row| row.what == "first name is the true one";
    assert!(!summary.rows.iter().any(clean), "no empty rows: {summary}");
}

#[test]
fn a_claimed_shrink_and_its_interval_are_compared_with_another_load() {
    let mut truth = messy();
    truth.transfer_floor = Some(0.5);
    let mut said = says("explained", &[("lag", 0.9, &[])]);
    said.gap.shrink_interval = Some([0.85, 1.0]);
    let gaps = |corrected| Gaps {
        fresh: Some(FreshGaps {
            nominal: 2.0,
            corrected: 0.1,
        }),
        transfer: Some(FreshGaps {
            nominal: 2.0,
            corrected,
        }),
    };
    let outcome = judge(&truth, Some(&said), gaps(0.8), None);
    let transfer = outcome.transfer.unwrap();
    assert!((transfer.shrink - 0.8).abs() < 1e-12, "{transfer:?}");
    assert!((transfer.over_claimed.unwrap() - 0.8 / 0.9).abs() < 1e-12);
    assert_eq!(transfer.interval_holds, Some(false));
    // A shrink slightly above 1 is not outside an interval that ends at 1.
    assert_eq!(outcome.fresh.unwrap().interval_holds, Some(true));
    let worse = judge(&truth, Some(&said), gaps(2.3), None);
    let summary = Summary::of(vec![outcome, worse]);
    let measured = |what: &str| {
        let row = summary.rows.iter().find(|row| row.what.contains(what));
        row.and_then(|row| row.measured)
    };
    let worst = measured("claimed one, worst").unwrap();
    assert!((worst + 0.2 / 0.9).abs() < 1e-12, "{worst}");
    assert_eq!(measured("transfer: 95 % shrink intervals"), Some(0.0));
    assert_eq!(measured("hold on fresh data"), Some(1.0));
}
