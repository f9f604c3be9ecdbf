//! Compares the lab's Simulink model with figures 3 and 4 of the report.

use host_sim::lab_model::{FRICTION_FROM_RAD_S, LabDrive, LabModel, LabSample};
use host_sim::presets;

fn sine(amplitude_nm: f64) -> Vec<LabSample> {
    let drive = LabDrive::Sine {
        amplitude_nm,
        frequency_hz: 1.0,
    };
    LabModel::at_rest(presets::nominal(), drive).run(20.0)
}

fn range_deg(samples: &[LabSample]) -> [f64; 2] {
    let position = || samples.iter().map(|s| s.position_rad.to_degrees());
    [
        position().fold(f64::INFINITY, f64::min),
        position().fold(f64::NEG_INFINITY, f64::max),
    ]
}

#[test]
fn the_sines_have_the_ranges_of_the_figures() {
    let [low, high] = range_deg(&sine(0.0011));
    assert!((low + 51.8).abs() < 0.1 && (high - 49.5).abs() < 0.1);
    let [low, high] = range_deg(&sine(0.00101)[1800..]);
    assert!((low + 13.0).abs() < 1.0 && (high - 13.0).abs() < 1.0);
}

#[test]
fn torque_passes_in_every_second_step_at_most_and_friction_never_acts() {
    let samples = sine(0.0011);
    assert!(samples.iter().any(|s| s.motor_nm != 0.0));
    for pair in samples.windows(2) {
        assert!(pair[0].motor_nm == 0.0 || pair[1].motor_nm == 0.0);
        assert!(pair[0].motor_nm == 0.0 || pair[0].motor_nm == pair[0].command_nm);
        assert!(pair[0].velocity_rad_s.abs() < FRICTION_FROM_RAD_S);
    }
    assert!(sine(0.00099).iter().all(|s| s.position_rad == 0.0));
}
