//! What a case promises, whatever is hidden in it.

use blind::{Case, GAP_OVER_FLOOR, Kind, Mixture, VOCABULARY};
use recording::Recording;

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
fn a_recording_of_every_name_reads_back_and_its_gap_is_in_range() {
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
fn a_case_depends_on_its_seed_and_number_alone() {
    let mixture = Mixture::default();
    let [first, again] = [3, 3].map(|case| Case::make(11, case, &mixture).unwrap());
    assert_eq!(first.truth, again.truth);
    assert_eq!(first.recording, again.recording);
    let other = Case::make(12, 3, &mixture).unwrap();
    assert_ne!(first.recording, other.recording);
}

#[test]
fn an_effect_that_does_not_exist_is_refused_with_the_names_that_do() {
    let error = Case::make(1, 1, &only("stribek")).unwrap_err().to_string();
    assert!(
        error.contains("`stribek`") && error.contains("stribeck"),
        "{error}"
    );
}
