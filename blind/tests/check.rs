//! Tests the check with a script in place of the diagnosis.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::time::Duration;

use blind::{Check, CheckError, Mixture};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("blind-check-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn check(folder: &std::path::Path, script: &str) -> Check {
    let program = folder.join("program");
    std::fs::write(&program, format!("#!/bin/sh\n{script}")).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    Check {
        program,
        folder: folder.join("cases"),
        cases: 2,
        seed: 5,
        mixture: Mixture {
            only: Some("torque_offset".into()),
            ..Mixture::default()
        },
        own_effect: None,
        withheld: None,
        jobs: 1,
        patience: Duration::from_secs(600),
    }
}

/// Always gives the same answer. Fails if it can see anything but the recording.
const ALWAYS_OFFSET: &str = r#"
[ "$1 $2 $4" = "gap diagnose --json" ] || exit 3
[ "$(ls "$3/.." | grep -v "^diagnosis.log$")" = recording ] || exit 4
[ "$(ls "$3" | grep -v -e '^run-.*csv$' )" = recording.toml ] || exit 5
cat > "$5" <<'END'
{"format": 1, "verdict": "explained", "gap": {"before": 1, "floor": 0, "after": 0, "shrink": 1},
 "effects": [{"name": "torque_offset", "confidence": 0.99}], "where": [], "elapsed_s": 0.1}
END
"#;

#[test]
fn the_diagnosis_can_read_only_the_recording_and_the_truth_is_written_afterwards() {
    let folder = folder("sealed");
    let check = check(&folder, ALWAYS_OFFSET);
    let summary = check.run(|_| ()).unwrap();
    assert!(
        summary.outcomes.iter().all(|outcome| outcome.right),
        "{summary}"
    );
    for case in ["case-0001", "case-0002"] {
        for kept in [
            "recording/recording.toml",
            "fresh/recording.toml",
            "truth.json",
            "diagnosis.json",
        ] {
            assert!(check.folder.join(case).join(kept).exists(), "{kept}");
        }
    }
    assert!(matches!(check.run(|_| ()), Err(CheckError::NotEmpty(_))));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_failed_diagnosis_counts_as_wrong_and_other_cases_continue() {
    let folder = folder("failing");
    let summary = check(&folder, "echo broken >&2; exit 2")
        .run(|_| ())
        .unwrap();
    assert_eq!(summary.outcomes.len(), 2);
    assert!(
        summary
            .outcomes
            .iter()
            .all(|outcome| outcome.answer == "failed" && !outcome.right)
    );
    let log = std::fs::read_to_string(folder.join("cases/case-0001/diagnosis.log")).unwrap();
    assert_eq!(log, "broken\n");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_withheld_effect_is_passed_to_the_diagnosis() {
    let folder = folder("withheld");
    let mut check = check(&folder, "echo \"$8 $9\"; exit 2");
    check.withheld = Some("torque_offset".into());
    check.cases = 1;
    check.run(|_| ()).unwrap();
    let log = std::fs::read_to_string(folder.join("cases/case-0001/diagnosis.log")).unwrap();
    assert_eq!(log, "--without torque_offset\n");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_diagnosis_that_exceeds_its_time_limit_is_stopped() {
    let folder = folder("endless");
    let mut check = check(&folder, "exec sleep 1000");
    check.cases = 1;
    check.patience = Duration::from_millis(50);
    let summary = check.run(|_| ()).unwrap();
    assert_eq!(summary.outcomes[0].answer, "failed");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Diagnoses and saves a model. `gap measure` reports half the nominal gap with this model, and no gap once the known load
/// is added.
const SAVES_A_MODEL: &str = r#"
if [ "$2" = measure ]; then
  case "$7" in
    "") gap=2.0 ;;
    *with-load*) gap=0.0 ;;
    *) gap=1.0 ;;
  esac
  echo "{\"format\": 1, \"gap\": {\"before\": $gap, \"floor\": 0.0}}"
  exit 0
fi
[ "$(ls "$3/.." | grep -v "^diagnosis.log$")" = recording ] || exit 4
[ "$(ls "$3" | grep -v -e '^run-.*csv$' )" = recording.toml ] || exit 5
printf '[model]\ninertia = 1.0\n' > "$7"
cat > "$5" <<'END'
{"format": 1, "verdict": "explained",
 "gap": {"before": 1, "floor": 0, "after": 0, "shrink": 1, "shrink_interval": [0.9, 1]},
 "effects": [{"name": "torque_offset", "confidence": 0.99}], "where": [], "elapsed_s": 0.1}
END
"#;

#[test]
fn a_messy_truth_is_written_after_the_diagnosis_and_the_known_load_is_added_to_the_saved_model() {
    let folder = folder("messy");
    let mut check = check(&folder, SAVES_A_MODEL);
    check.cases = 4;
    check.mixture.messy = true;
    check.mixture.transfer = true;
    let summary = check.run(|_| ()).unwrap();
    assert!(
        summary.outcomes.iter().all(|outcome| outcome.first),
        "{summary}"
    );
    for (k, outcome) in summary.outcomes.iter().enumerate() {
        let case = check.folder.join(format!("case-{:04}", k + 1));
        assert!(case.join("truth.json").exists());
        assert_eq!(
            case.join("model-with-load.toml").exists(),
            outcome.transfer.is_some()
        );
        assert!(outcome.transfer.is_none() || case.join("transfer/recording.toml").exists());
    }
    let kept: Vec<_> = summary.outcomes.iter().filter_map(|o| o.transfer).collect();
    assert!(
        !kept.is_empty() && kept.iter().all(|kept| kept.shrink > 0.99),
        "{kept:?}"
    );
    std::fs::remove_dir_all(folder).unwrap();
}
