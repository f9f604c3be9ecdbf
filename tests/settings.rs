//! Tests of the table of settings.

use haptic_paddle::settings::{FIELDS, Field, GROUPS, Kind, Page, SettingError, Settings};

/// Smallest and largest value of a setting.
fn bounds(field: &Field) -> [f32; 2] {
    match field.kind {
        Kind::Number { min, max } => [min, max],
        Kind::Choice(names) => [0.0, (names.len() - 1) as f32],
    }
}

#[test]
fn the_defaults_are_within_their_bounds() {
    Settings::default().check().unwrap();
}

#[test]
fn each_field_reads_back_its_value_and_changes_no_other() {
    for field in FIELDS {
        for value in bounds(field) {
            let mut settings = Settings::default();
            field.write(&mut settings, value).unwrap();
            assert_eq!(field.read(&settings), value, "{}", field.name);
            for other in FIELDS.iter().filter(|other| *other != field) {
                assert_eq!(
                    other.read(&settings),
                    other.default_value(),
                    "{} moved {}",
                    field.name,
                    other.name
                );
            }
        }
    }
}

#[test]
fn an_invalid_value_is_refused_and_changes_nothing() {
    for field in FIELDS {
        let [min, max] = bounds(field);
        for value in [
            min - 1.0,
            max + 1.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
        ] {
            let mut settings = Settings::default();
            assert!(
                field.write(&mut settings, value).is_err(),
                "{} {value}",
                field.name
            );
            assert_eq!(settings, Settings::default());
        }
    }
}

#[test]
fn a_shown_value_can_be_set_again() {
    let mut settings = Settings::default();
    settings.set("kp", "0.0123").unwrap();
    settings.set("estimate.sensor", "hall").unwrap();
    settings.set("compensation.gravity", "on").unwrap();
    let mut copy = Settings::default();
    for field in FIELDS {
        let shown = field.shown(&settings).to_string();
        let (name, rest) = shown.split_once(" = ").unwrap();
        copy.set(name, rest.split(' ').next().unwrap()).unwrap();
    }
    assert_eq!(copy, settings);
}

#[test]
fn names_are_unique() {
    let mut names: Vec<_> = FIELDS
        .iter()
        .flat_map(|field| [Some(field.name), field.short])
        .flatten()
        .collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn refusals_name_the_setting_and_its_allowed_values() {
    let mut settings = Settings::default();
    let message = |error: SettingError| error.to_string();
    assert_eq!(
        message(settings.set("kd", "-1").unwrap_err()),
        "pid.kd must be a number from 0 to 0.1 N m s/deg at the paddle"
    );
    assert_eq!(
        message(settings.set("estimate.sensor", "ears").unwrap_err()),
        "estimate.sensor must be one of encoder, hall"
    );
    assert_eq!(
        settings.set("pid.kq", "1").unwrap_err(),
        SettingError::Unknown
    );
}

#[test]
fn each_setting_has_a_description_and_a_group() {
    for field in FIELDS {
        assert!(
            field.about.ends_with('.'),
            "{}: {}",
            field.name,
            field.about
        );
        assert!(
            !field.about.contains("  "),
            "{}: {}",
            field.name,
            field.about
        );
        let group = field.name.split('.').next();
        assert!(
            GROUPS.iter().any(|known| Some(known.name) == group),
            "{}",
            field.name
        );
    }
}

#[test]
fn the_page_of_settings_is_current() {
    let page = std::fs::read_to_string("docs/settings.md").unwrap_or_default();
    assert!(
        page == Page.to_string(),
        "docs/settings.md is old; make it anew: cargo run --quiet --example settings_page > docs/settings.md"
    );
}
