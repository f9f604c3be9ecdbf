//! A Python module without dependencies that simulates the device step by step.

use crate::model::Model;
use crate::part::Part;
use crate::part::stops;
use crate::writer::{Writer, number};
use std::fmt::Write;

pub(crate) struct Python;

/// Parts that both step-by-step exports express: those whose only states are position, velocity, delay and lags.
pub(crate) fn steps(part: Part) -> bool {
    use Part::{
        Backlash, Compliance, Contact, FrictionDrift, LostCounts, Presliding, SensorHysteresis,
        SensorLag,
    };
    !matches!(
        part,
        Backlash
            | Compliance
            | Contact
            | FrictionDrift
            | LostCounts
            | Presliding
            | SensorHysteresis
            | SensorLag
    )
}

/// Names and values of the numbers for both step-by-step exports.
pub(crate) fn numbers(model: &Model) -> Vec<(&'static str, f64)> {
    let device = &model.device;
    let (drive, mechanics, sensing) = (&device.drive, &device.mechanics, &device.sensing);
    let friction = &mechanics.friction;
    let cogging = mechanics.cogging;
    let [lower, upper] = stops(device);
    let of = |stop: &Option<host_sim::plant::Barrier>,
              number: fn(&host_sim::plant::Barrier) -> f64,
              none: f64| { stop.as_ref().map_or(none, number) };
    vec![
        ("inertia", mechanics.inertia),
        ("ratio", drive.ratio),
        ("limit", drive.limit),
        ("saturation_limit", drive.saturation.limit),
        ("saturation_knee", drive.saturation.knee),
        ("no_load_velocity", drive.saturation.no_load_velocity),
        ("deadband", drive.deadband),
        ("deadband_jump", drive.deadband_jump),
        ("deadband_skew", drive.deadband_skew),
        ("deadband_first", f64::from(u8::from(drive.deadband_first))),
        // A delay below zero is that of a recording's column.
        ("delay_s", drive.delay_s.max(0.0)),
        ("lag_s", drive.lag_s),
        ("further_lag_s", drive.further_lag_s),
        ("offset", mechanics.offset_nm),
        ("viscous", mechanics.viscous),
        ("drag", mechanics.drag),
        ("gravity", mechanics.gravity),
        ("gravity_zero", mechanics.gravity_zero),
        ("angle_rad", mechanics.angle_rad),
        ("stiffness", mechanics.stiffness),
        ("stiffness_zero", mechanics.stiffness_zero),
        ("hardening", mechanics.hardening),
        (
            "cogging",
            cogging.map_or(0.0, |cogging| cogging.first.amplitude_nm),
        ),
        (
            "cogging_wave_number",
            cogging.map_or(0.0, |cogging| cogging.first.wave_number),
        ),
        (
            "cogging_phase",
            cogging.map_or(0.0, |cogging| cogging.first.phase),
        ),
        (
            "cogging_second_sine",
            cogging.map_or(0.0, |cogging| cogging.second_nm[0]),
        ),
        (
            "cogging_second_cosine",
            cogging.map_or(0.0, |cogging| cogging.second_nm[1]),
        ),
        ("level_forward", friction.level_nm[0]),
        ("level_backward", friction.level_nm[1]),
        ("static_ratio", friction.stribeck.ratio),
        ("stribeck_velocity", friction.stribeck.velocity),
        ("stribeck_exponent", friction.stribeck.exponent),
        ("stribeck_tail", friction.stribeck.tail),
        ("level_slope", friction.position_slope),
        ("level_curve", friction.position_curve),
        ("level_sine", friction.position_ripple.sine),
        ("level_cosine", friction.position_ripple.cosine),
        ("level_wave_number", friction.position_ripple.wave_number),
        ("spot_height", friction.position_spot.height),
        ("spot_position", friction.position_spot.position),
        ("spot_width", friction.position_spot.width),
        ("spot_exponent", friction.position_spot.exponent),
        ("load_share", friction.load_share),
        ("load_backdriven_extra", friction.load_backdriven_extra),
        ("load_passive", friction.load_passive),
        ("lower_stop", of(&lower, |stop| stop.at, f64::NEG_INFINITY)),
        ("lower_stiffness", of(&lower, |stop| stop.stiffness, 0.0)),
        ("lower_damping", of(&lower, |stop| stop.damping, 0.0)),
        ("upper_stop", of(&upper, |stop| stop.at, f64::INFINITY)),
        ("upper_stiffness", of(&upper, |stop| stop.stiffness, 0.0)),
        ("upper_damping", of(&upper, |stop| stop.damping, 0.0)),
        ("sensor_gain", sensing.gain),
        ("sensor_quadratic", sensing.quadratic),
        ("sensor_cubic", sensing.cubic),
        ("sensor_offset", sensing.offset),
        ("sensor_sine", sensing.ripple.sine),
        ("sensor_cosine", sensing.ripple.cosine),
        ("sensor_wave_number", sensing.ripple.wave_number),
    ]
}

impl Writer for Python {
    fn expresses(&self, part: Part) -> bool {
        steps(part)
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let mut text = String::from("\"\"\"");
        // Writing to a `String` cannot fail.
        for note in notes {
            let _ = writeln!(text, "{}", note.replace('\\', "/").replace('"', "'"));
        }
        let _ = writeln!(
            text,
            "\nSI units. Steps of at most 0.1 ms are right.\n\"\"\"\n\nimport math\nfrom collections import deque\n\nNUMBERS = {{"
        );
        for (name, value) in numbers(model) {
            let shown = match value {
                f64::INFINITY => "math.inf".to_owned(),
                f64::NEG_INFINITY => "-math.inf".to_owned(),
                value => number(value),
            };
            let _ = writeln!(text, "    \"{name}\": {shown},");
        }
        text.push_str("}\n");
        text.push_str(include_str!("step.py"));
        text
    }
}
