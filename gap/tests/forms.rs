//! An effect of another form than the simplest is found as that effect alone, with the numbers of its form.

mod made;

use gap::diagnosis::Finding;
use gap::{Options, Recording, diagnose};
use host_sim::device::Device;
use host_sim::effects::Effect;
use made::{paddle, recorded, recording};
use recording::Model;

#[test]
fn a_spot_that_rubs_is_found_where_it_is() {
    assert_found(
        "position_dependent_coulomb:slope=0,spot=1.5,spot_position=0.05,spot_width=0.12",
        &[("spot", 1.5), ("spot_position", 0.05), ("spot_width", 0.12)],
    );
}

#[test]
fn what_grows_with_the_weight_as_with_the_drive_is_found() {
    assert_found(
        "load_dependent_friction:share=0.2,passive=1",
        &[("share", 0.2), ("passive", 1.0)],
    );
}

#[test]
fn a_drive_that_adds_torque_with_speed_is_viscous_friction_below_zero() {
    assert_found("viscous:coefficient=-0.0008", &[("coefficient", -0.0008)]);
}

#[test]
fn what_rubs_more_where_the_load_drives_is_found() {
    assert_found(
        "load_dependent_friction:share=0.05,backdriven_extra=0.15",
        &[("share", 0.05), ("backdriven_extra", 0.15)],
    );
}

#[test]
fn a_gain_that_falls_beyond_a_knee_of_the_input_is_found() {
    assert_found(
        "input_nonlinearity:slope_beyond=0.2,knee=0.0015",
        &[("slope_beyond", 0.2), ("knee", 1.5e-3)],
    );
}

#[test]
fn what_settles_at_the_level_of_the_model_is_no_other_level() {
    assert_found(
        "friction_drift:rate=-0.5,settling=1.5,settled=1",
        &[("rate", -0.5), ("settling", 1.5), ("settled", 1.0)],
    );
}

#[test]
fn what_comes_loose_at_once_is_another_friction_from_then_on() {
    assert_found(
        "friction_drift:rate=0,step=-0.4,step_at=3",
        &[("step", -0.4), ("step_at", 3.0)],
    );
}

#[test]
fn a_ripple_of_three_orders_is_found_with_all_of_them() {
    let waves = "amplitude_1=0.004,wave_number_1=21,phase_1=0.4,amplitude_2=0.0025,wave_number_2=37,phase_2=1.9,\
                 amplitude_3=0.002,wave_number_3=62,phase_3=-1.1";
    let mut device = Device::nominal(&paddle());
    let ripple = format!("cogging:{waves}");
    ripple.parse::<Effect>().unwrap().install(&mut device);
    let recording = recorded(&device, paddle(), 5e-5, 0.0, 11);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let effect = &found.effects[0];
    assert_eq!((effect.name, found.effects.len()), ("cogging", 1));
    let value = |name: &str| effect.parameters.get(name).map_or(f64::NAN, |e| e.value);
    let mut orders = [1, 2, 3].map(|k| {
        [
            value(&format!("wave_number_{k}")),
            value(&format!("amplitude_{k}")),
        ]
    });
    orders.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (order, expected) in orders
        .iter()
        .zip([[21.0, 0.004], [37.0, 0.0025], [62.0, 0.002]])
    {
        let off = [0, 1].map(|i| (order[i] / expected[i] - 1.0).abs());
        assert!(off[0] < 0.02 && off[1] < 0.1, "{orders:?}");
    }
}

#[test]
fn a_spring_that_hardens_at_once_is_no_stop() {
    assert_found(
        "spring:stiffness=0.005,zero=0.02,hardening=20",
        &[("stiffness", 0.005), ("hardening", 20.0)],
    );
}

#[test]
fn a_gain_that_falls_with_the_input_is_a_curve_of_the_input() {
    assert_found(
        "input_nonlinearity:gain=1.05,power=0.6,reference=0.004",
        &[("power", 0.6)],
    );
}

#[test]
fn a_dead_band_that_lies_off_zero_is_no_offset() {
    assert_found(
        "deadband:width=2e-4,skew=0.5",
        &[("width", 2e-4), ("skew", 0.5)],
    );
}

#[test]
fn a_gain_that_reads_right_elsewhere_than_at_zero_is_no_bent_curve() {
    assert_found(
        "sensor_gain:gain=0.9,zero=0.3",
        &[("gain", 0.9), ("zero", 0.3)],
    );
}

#[test]
fn two_lags_in_a_row_are_no_delay() {
    let form = [("time", 0.004), ("twice", 1.0)];
    assert_found("lag:time=0.004,twice=1", &form);
    assert_found("sensor_lag:time=0.004,twice=1", &form);
}

#[test]
fn a_limit_that_falls_with_speed_is_a_saturation() {
    assert_found(
        "saturation:limit=0.002,no_load=1.5",
        &[("limit", 0.002), ("no_load", 1.5)],
    );
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

/// Asserts that an effect is the only one that is named, with the numbers that are expected.
#[track_caller]
fn assert_found(written: &str, expected: &[(&str, f64)]) {
    let effect: Effect = written.parse().unwrap();
    let mut device = Device::nominal(&paddle());
    effect.install(&mut device);
    let found = only(&recorded(&device, paddle(), 5e-5, 0.0, 11));
    assert_eq!(found.name, effect.kind.name);
    for (name, expected) in expected {
        let fitted = &found.parameters[*name];
        let ratio = fitted.value / expected;
        assert!((ratio - 1.0).abs() < 0.03, "{name}: {fitted:?}");
    }
}

/// The only effect that is named.
fn only(recording: &Recording) -> Finding {
    let found = diagnose(recording, &Options::default()).diagnosis;
    let [finding] = found.effects.try_into().unwrap();
    finding
}
