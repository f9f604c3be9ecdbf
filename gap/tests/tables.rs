//! A torque that no effect has the form of is added to a corrected model as a table, if that predicts.

mod made;

use gap::effects::add_own;
use gap::{Device, ModelFile, Options, Tabulated, diagnose, measure, tabulated};
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};

/// Resists only at a middle speed, as no effect of the library does.
const HUMP: &str = r#"
    name = "hump"
    about = "a torque that resists at a middle speed"
    torque = "-h * signum(v) * exp(-((abs(v) - w) / (0.3 * w))^2)"
    [parameters.h]
    typical = [1e-3, 1.0]
    [parameters.w]
    typical = [0.3, 30.0]
"#;

#[test]
fn a_table_closes_what_has_no_name_and_is_saved_with_the_model() {
    add_own(HUMP).expect("it is one");
    let mut device = Device::nominal(&paddle());
    let hump: Effect = "hump:h=0.006,w=6".parse().expect("it is known");
    hump.install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
    let options = Options {
        without: host_sim::effects::KINDS
            .iter()
            .map(|kind| kind.name.to_owned())
            .chain(["hump".to_owned()])
            .collect(),
        ..Options::default()
    };
    let outcome = diagnose(&recording, &options);
    let (before, _) = measure(&recording, &outcome.model.device());
    let came = tabulated(&recording, &outcome.model);
    let Tabulated::Closes { table, shrink } = came else {
        panic!("{came:?}");
    };
    assert_eq!(table.axis.name(), "velocity");
    let mut model = outcome.model.clone();
    model.tables.push(table);
    assert!(shrink > 0.4, "{shrink}");
    let (after, _) = measure(&recording, &model.device());
    assert!(after.before < 0.6 * before.before, "{after:?} {before:?}");

    let saved = ModelFile::new(&model, &recording).to_string();
    let read: ModelFile = saved.parse().expect("it reads back");
    let (read, _) = read.on(&recording).expect("it is sound");
    let (again, _) = measure(&recording, &read.device());
    assert_eq!(again, after);
    let bent = saved.replace("at = [", "at = [9e9, ");
    let bent: ModelFile = bent.parse().expect("it is TOML");
    let refused = bent.on(&recording).expect_err("it does not ascend");
    assert!(refused.to_string().contains("[[tables]]"), "{refused}");
}

#[test]
fn where_nothing_is_missing_a_table_closes_nothing() {
    let recording = recording(&paddle(), paddle(), 5e-5, 0.0, 11);
    let outcome = diagnose(&recording, &Options::default());
    let came = tabulated(&recording, &outcome.model);
    assert!(!matches!(came, Tabulated::Closes { .. }), "{came:?}");
}
