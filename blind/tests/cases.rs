//! Properties that every case has, whatever is hidden in it.

use blind::{Case, GAP_OVER_FLOOR, Kind, Mixture, OwnEffect, SMALL_SHARE, VOCABULARY};
use recording::Recording;
use std::sync::LazyLock;

fn only(name: &str) -> Mixture {
    Mixture {
        only: Some(name.into()),
        ..Mixture::default()
    }
}

fn folder(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("blind-{name}-{}", std::process::id()))
}

#[test]
fn a_recording_with_each_effect_can_be_read_back_and_its_gap_is_in_range() {
    for name in VOCABULARY {
        let case = Case::make(7, 1, &only(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(case.truth.kind, Kind::Single);
        assert_eq!(case.truth.effects[0].name, name);
        assert!(
            !case.truth.effects[0].places.is_empty(),
            "{name} acts nowhere"
        );
        let ratio = case.truth.reference.hidden_alone / case.truth.reference.after;
        assert!(
            (GAP_OVER_FLOOR[0]..GAP_OVER_FLOOR[1]).contains(&ratio),
            "{name}: {ratio}"
        );
        for (kind, recording) in [("given", &case.recording), ("fresh", &case.fresh)] {
            let folder = folder(&format!("{name}-{kind}"));
            recording.write(&folder).unwrap();
            let read = Recording::read(&folder).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(read.runs, recording.runs, "{name}");
            std::fs::remove_dir_all(&folder).unwrap();
        }
    }
}

#[test]
fn an_effect_of_the_user_is_hidden_within_its_typical_values() {
    let text = "name = \"eddy_brake\"\nabout = \"a brake\"\ntorque = \"-k * v / (1 + (v / v0)^2)\"\n\
                [parameters.k]\ntypical = [1e-5, 1e-2]\n[parameters.v0]\ntypical = [1.0, 50.0]\n";
    for (messy, kind) in [(false, Kind::Single), (true, Kind::Messy)] {
        let mixture = Mixture {
            own: Some(OwnEffect::read(text).unwrap()),
            messy,
            ..Mixture::default()
        };
        let case = Case::make(5, 1, &mixture).unwrap();
        let dominant = &case.truth.effects[0];
        assert_eq!(
            (dominant.name.as_str(), case.truth.kind),
            ("eddy_brake", kind)
        );
        assert!(
            (1e-5..=1e-2).contains(&dominant.strength),
            "{}",
            dominant.strength
        );
    }
}

#[test]
fn an_effect_of_the_user_needs_a_formula_and_typical_values() {
    for (torque, typical) in [("-k *", "[1, 2]"), ("-k * v", "[2, 1]")] {
        let text =
            format!("name = \"own\"\ntorque = \"{torque}\"\n[parameters.k]\ntypical = {typical}\n");
        let error = OwnEffect::read(&text).unwrap_err().to_string();
        assert!(
            error.contains("formula") || error.contains("typical"),
            "{error}"
        );
    }
}

#[test]
fn a_case_depends_on_its_seed_and_number_alone() {
    let mixture = Mixture::default();
    let [first, again] = [3, 3].map(|case| Case::make(11, case, &mixture).unwrap());
    assert_eq!(first.truth, again.truth);
    assert_eq!(first.recording, again.recording);
    let other = Case::make(12, 3, &mixture).unwrap();
    assert_ne!(first.recording, other.recording);
}

#[test]
fn an_unknown_effect_is_refused_with_the_list_of_valid_names() {
    let error = Case::make(1, 1, &only("stribek")).unwrap_err().to_string();
    assert!(
        error.contains("`stribek`") && error.contains("stribeck"),
        "{error}"
    );
}

fn messy() -> Mixture {
    Mixture {
        messy: true,
        transfer: true,
        ..Mixture::default()
    }
}

/// Some messy cases. They are shared because one takes a second to make.
static MESSY: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let cases = (1..=8).map(|case| Case::make(23, case, &messy()));
    cases.map(Result::unwrap).collect()
});

#[test]
fn a_messy_case_depends_on_its_seed_and_number_alone() {
    let case = &MESSY[2];
    let again = Case::make(23, 3, &messy()).unwrap();
    assert_eq!(case.truth, again.truth);
    assert_eq!(case.recording, again.recording);
    assert_eq!(case.fresh, again.fresh);
    let transfers = [case, &again].map(|case| case.transfer.as_ref().map(|t| &t.recording));
    assert_eq!(transfers[0], transfers[1]);
    let other = Case::make(24, 3, &messy()).unwrap();
    assert_ne!(case.recording, other.recording);
}

#[test]
fn every_small_cause_has_5_to_25_percent_of_the_size_of_the_dominant_one() {
    for case in MESSY.iter() {
        let truth = &case.truth;
        assert_eq!(truth.kind, Kind::Messy);
        assert_eq!(truth.effects[0].share, Some(1.0), "{:?}", truth.effects[0]);
        let shares: Vec<f64> = truth.effects.iter().filter_map(|e| e.share).collect();
        assert_eq!(shares.len(), truth.effects.len(), "each has a share");
        assert!(
            shares[1..].is_sorted_by(|a, b| a >= b),
            "the list goes by size: {shares:?}"
        );
        let small: Vec<f64> = truth.effects[1..]
            .iter()
            .filter(|effect| effect.form.starts_with("Hidden") || effect.form.starts_with("Cause"))
            .filter_map(|effect| effect.share)
            .collect();
        assert!((3..=5).contains(&small.len()), "{small:?}");
        let [low, high] = SMALL_SHARE;
        assert!(
            small.iter().all(|share| (low..=high).contains(share)),
            "{small:?}"
        );
        let timing = truth.timing.expect("a messy case says what its times are");
        assert!(timing.share <= high, "{timing:?}");
        assert!(timing.offset_rows.abs() <= 0.5, "{timing:?}");
    }
}

#[test]
fn stated_numbers_of_a_messy_case_have_errors_up_to_30_percent_and_plausible_tolerances() {
    for case in MESSY.iter() {
        for effect in &case.truth.effects {
            let Some(number) = effect.form.strip_prefix("stated ") else {
                continue;
            };
            let number = number.split_whitespace().next().unwrap();
            assert!(effect.strength.abs() <= 0.3, "{number}: {effect:?}");
            let stated = case
                .recording
                .tolerance
                .iter()
                .find(|(name, _)| *name == number);
            if let Some((_, tolerance)) = stated {
                let error = effect.strength.abs() / (1.0 + effect.strength);
                // A small error may have a larger tolerance. A large error never has a tiny tolerance.
                assert!(error < 2.1 * tolerance, "{number}: {error} of {tolerance}");
            }
        }
    }
}

#[test]
fn rows_of_a_messy_case_have_uneven_times_and_rates_of_50_to_10_000_hz() {
    for case in MESSY.iter() {
        for run in &case.recording.runs {
            let rate_hz = (run.len() - 1) as f64 / run.duration_s();
            assert!((45.0..11_000.0).contains(&rate_hz), "{rate_hz} Hz");
            let first_s = run.time[1] - run.time[0];
            let even = run.time.windows(2).all(|pair| pair[1] - pair[0] == first_s);
            assert!(!even, "{}: all periods are {first_s} s", run.file);
        }
    }
}

#[test]
fn a_transfer_recording_changes_only_load_excitation_and_amplitude_of_the_device() {
    let case = MESSY.iter().find(|case| case.transfer.is_some());
    let case = case.expect("one of eight devices takes another load");
    let transfer = case.transfer.as_ref().unwrap();
    let [mut with, without] = [transfer.recording.model, case.recording.model];
    assert!(transfer.load_inertia > 0.0);
    assert!(
        (with.inertia - without.inertia - transfer.load_inertia).abs() < 1e-12 * with.inertia,
        "{with:?} {without:?}"
    );
    with.inertia = without.inertia;
    assert_eq!(with, without);
    let half_span = |recording: &Recording| {
        let position = recording.runs.iter().flat_map(|run| &run.position);
        let (low, high) = position.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
        0.5 * (high - low)
    };
    let over = half_span(&transfer.recording) / half_span(&case.recording);
    assert!((over - 1.0).abs() > 0.1, "amplitude times {over}");
}

#[test]
fn asking_for_a_transfer_recording_does_not_change_the_case() {
    let transfer = Mixture {
        transfer: true,
        ..Mixture::default()
    };
    for number in 1..=2 {
        let [plain, other] = [Mixture::default(), transfer.clone()]
            .map(|mixture| Case::make(31, number, &mixture).unwrap());
        assert_eq!(plain.recording, other.recording);
        assert_eq!(plain.fresh, other.fresh);
        assert_eq!(plain.truth.effects, other.truth.effects);
        assert!(plain.transfer.is_none());
    }
}
