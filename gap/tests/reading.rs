//! What a sensor makes of the position may be small and change often over the whole of the motion.

mod made;

use gap::{Options, Recording, diagnose};
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

fn named(recording: &Recording) -> Vec<&'static str> {
    let found = diagnose(recording, &Options::default()).diagnosis;
    found.effects.iter().map(|e| e.name).collect()
}
