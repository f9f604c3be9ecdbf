//! What a sensor makes of the position may be small and change often over the whole of the motion.

mod made;

use gap::diagnosis::Verdict;
use gap::{ModelFile, Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};

#[test]
fn what_is_small_beside_the_span_is_found() {
    for effect in [
        "sensor_hysteresis:width=0.004",
        "sensor_nonlinearity:quadratic=0,ripple_sine=0.003,ripple_cosine=0.002,wave_number=37",
    ] {
        let mut device = Device::nominal(&paddle());
        let effect: Effect = effect.parse().unwrap();
        effect.install(&mut device);
        let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
        assert_eq!(named(&recording), [effect.kind.name]);
    }
    let nothing = recording(&paddle(), paddle(), 5e-5, 0.0, 11);
    assert!(named(&nothing).is_empty());
}

#[test]
fn counts_that_are_lost_at_speed_are_found_and_belong_to_no_moment() {
    const SHARE: f64 = 0.3;
    const SPEED: f64 = 1.0;
    let mut device = Device::nominal(&paddle());
    let hidden = format!("lost_counts:jump=0,share={SHARE},speed={SPEED}");
    hidden.parse::<Effect>().unwrap().install(&mut device);
    let recording = recorded(&device, paddle(), 1e-4, 0.0, 1);
    let outcome = diagnose(&recording, &Options::default());
    let said = &outcome.diagnosis;
    assert_eq!(
        (said.verdict, said.effects[0].name),
        (Verdict::Explained, "lost_counts")
    );
    for (name, hidden) in [("share", SHARE), ("speed", SPEED)] {
        let found = said.effects[0].parameters[name].value;
        assert!((found / hidden - 1.0).abs() < 0.03, "{name}: {found}");
    }
    let file = ModelFile::new(&outcome.model, &recording).to_string();
    assert!(!file.contains("moments"), "{file}");
}

fn named(recording: &Recording) -> Vec<&'static str> {
    let found = diagnose(recording, &Options::default()).diagnosis;
    found.effects.iter().map(|e| e.name).collect()
}
