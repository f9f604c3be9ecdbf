//! What rubs at one place is found there, and what rubs everywhere is no place.

mod made;

use gap::diagnosis::Finding;
use gap::{Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

#[test]
fn a_spot_that_rubs_is_found_where_it_is() {
    let mut device = Device::nominal(&paddle());
    let spot = "position_dependent_coulomb:slope=0,spot=1.5,spot_position=0.05,spot_width=0.12";
    let spot: Effect = spot.parse().unwrap();
    spot.install(&mut device);
    let found = only(&recorded(&device, paddle(), 5e-5, 0.0, 11));
    assert_eq!(found.name, "position_dependent_coulomb");
    for (name, expected) in [("spot", 1.5), ("spot_position", 0.05), ("spot_width", 0.12)] {
        let fitted = &found.parameters[name];
        assert!(
            (fitted.value / expected - 1.0).abs() < 0.03,
            "{name}: {fitted:?}"
        );
    }
}

#[test]
fn what_rubs_more_everywhere_is_another_level() {
    let more = Model {
        coulomb: 1.5 * paddle().coulomb,
        ..paddle()
    };
    let found = only(&recording(&more, paddle(), 5e-5, 0.0, 11));
    assert_eq!(found.name, "coulomb");
}

/// The only effect that is named.
fn only(recording: &Recording) -> Finding {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let [finding] = found.effects.try_into().unwrap();
    finding
}
