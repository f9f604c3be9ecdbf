//! Tests the exported files.

use export::{Exported, Format, Model, Part, exported, parts};
use haptic_paddle::settings::Settings;
use host_sim::device::Device;
use host_sim::effects::{Effect, KINDS};

fn nominal() -> recording::Model {
    recording::Model {
        viscous: 2e-4,
        coulomb: 4e-3,
        gravity: 0.0146,
        gravity_zero: 0.05,
        ratio: 15.0,
        input_limit: Some(0.03),
        ..recording::Model::new(5.8e-4)
    }
}

fn with(effects: &[&str]) -> Model {
    let mut device = Device::nominal(&nominal());
    for effect in effects {
        let effect: Effect = effect.parse().expect("an effect");
        effect.install(&mut device);
    }
    Model {
        name: "a <paddle> & \"co\"".into(),
        device,
        is_linear: false,
    }
}

#[test]
fn every_effect_is_expressed_approximated_or_listed_as_missing() {
    for kind in KINDS {
        let model = with(&[kind.name]);
        for format in Format::ALL {
            let Exported {
                text,
                approximated,
                left_out,
            } = exported(&model, format);
            assert!(!text.is_empty(), "{} {format:?}", kind.name);
            for part in &left_out {
                assert!(
                    text.contains(part.name()),
                    "{} is not at the head of {format:?}",
                    part.name()
                );
            }
            for (part, how) in &approximated {
                assert!(
                    text.contains(how) && !left_out.contains(part),
                    "{} {format:?}",
                    kind.name
                );
            }
        }
    }
}

#[test]
fn a_device_without_effects_has_no_parts() {
    let found = parts(&Device::nominal(&recording::Model::new(1.0)));
    assert_eq!(found, []);
    let found = parts(&with(&[]).device);
    assert_eq!(
        found,
        [Part::Limit, Part::Coulomb, Part::Viscous, Part::Gravity]
    );
}

#[test]
fn xml_is_escaped_and_closed() {
    for format in [Format::Mjcf, Format::Urdf] {
        let Exported { text, .. } = exported(&with(&["backlash"]), format);
        assert!(
            text.contains("a &lt;paddle> &amp; &quot;co&quot;"),
            "{text}"
        );
        let closed = if format == Format::Mjcf {
            "</mujoco>"
        } else {
            "</robot>"
        };
        assert!(text.trim_end().ends_with(closed), "{text}");
    }
}

#[test]
fn the_console_settings_have_the_friction_at_the_motor() {
    let Exported { text, .. } = exported(&with(&["asymmetric_coulomb"]), Format::Console);
    let set = |name: &str| {
        let line = text
            .lines()
            .find(|line| line.starts_with(&format!("set {name} ")))
            .expect(name);
        line.rsplit(' ')
            .next()
            .and_then(|value| value.parse::<f64>().ok())
            .expect("a number")
    };
    let [forward, backward] = with(&["asymmetric_coulomb"])
        .device
        .mechanics
        .friction
        .level_nm;
    assert!(
        (set("compensation.dry_forward") - forward / 15.0).abs() < 1e-9,
        "{text}"
    );
    assert!(
        (set("compensation.dry_backward") - backward / 15.0).abs() < 1e-9,
        "{text}"
    );
    assert!(
        (set("compensation.gravity_zero") - 0.05_f64.to_degrees()).abs() < 1e-5,
        "{text}"
    );
}

#[test]
fn a_format_is_found_by_its_name() {
    for format in Format::ALL {
        assert_eq!(format.name().parse(), Ok(format));
    }
    let unknown = "sdf".parse::<Format>().expect_err("no format").to_string();
    assert!(
        unknown.contains("`sdf`") && unknown.contains("simulink-m"),
        "{unknown}"
    );
}

#[test]
fn the_control_core_accepts_every_line_for_the_console() {
    for effects in [&[][..], &["asymmetric_coulomb"], &["stribeck", "viscous"]] {
        let Exported { text, .. } = exported(&with(effects), Format::Console);
        let mut settings = Settings::default();
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        for line in lines {
            let words: Vec<&str> = line.split(' ').collect();
            let ["set", name, value] = words[..] else {
                panic!("{line}");
            };
            settings
                .set(name, value)
                .unwrap_or_else(|error| panic!("{line}: {error}"));
        }
        let compensation = &settings.compensation;
        assert!(
            compensation.dry && compensation.viscous && compensation.gravity,
            "{text}"
        );
    }
}
