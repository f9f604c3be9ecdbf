//! MuJoCo's XML (<https://mujoco.readthedocs.io/en/stable/XMLreference.html>), version 3 and later.

use crate::model::Model;
use crate::part::Part;
use crate::part::{limit, stops};
use crate::pendulum::{GRAVITY_M_S2, Pendulum};
use crate::writer::{Writer, number};
use std::fmt::Write;

/// Step of the simulation, s; short enough for a dry friction that sticks within it.
const TIMESTEP_S: f64 = 1e-4;
/// Share of an inertia that the body has as such, so that none is without.
const BODY_SHARE: f64 = 1e-3;

/// A dry friction that stops what moves within one step: MuJoCo's slows at the rate 2 over the time constant, and takes none
/// below two steps, so that this one stands for two steps of any length.
const FRICTION: &str = "solreffriction=\"2e-05 1\" solimpfriction=\"0.9999 0.9999 0.001 0.5 2\"";
/// Where there is no stop, in units of position.
const FAR: f64 = 1e6;

pub(crate) struct Mjcf;

impl Writer for Mjcf {
    fn expresses(&self, part: Part) -> bool {
        use Part::{
            AsymmetricCoulomb, Backlash, Compliance, Coulomb, Delay, EndStop, Gravity, Hardening,
            Lag, Limit, Offset, QuadraticDrag, SensorGain, Spring, Viscous,
        };
        matches!(
            part,
            AsymmetricCoulomb
                | Backlash
                | Compliance
                | EndStop
                | Coulomb
                | Delay
                | Gravity
                | Hardening
                | Lag
                | Limit
                | Offset
                | QuadraticDrag
                | SensorGain
                | Spring
                | Viscous
        )
    }

    fn text(&self, model: &Model, notes: &[String]) -> String {
        let mut text = String::new();
        for note in notes {
            put(
                &mut text,
                0,
                &format!("<!-- {} -->", note.replace("--", "- -")),
            );
        }
        put(
            &mut text,
            0,
            &format!("<mujoco model=\"{}\">", escaped(&model.name)),
        );
        put(
            &mut text,
            1,
            "<compiler angle=\"radian\" autolimits=\"true\" balanceinertia=\"true\"/>",
        );
        put(
            &mut text,
            1,
            &format!(
                "<option timestep=\"{TIMESTEP_S}\" integrator=\"implicitfast\" gravity=\"0 0 -{GRAVITY_M_S2}\" tolerance=\"1e-12\"/>"
            ),
        );
        world(&mut text, model);
        tendons(&mut text, model);
        actuators(&mut text, model);
        put(&mut text, 1, "<sensor>");
        put(
            &mut text,
            2,
            "<tendonpos name=\"position\" tendon=\"position\"/>",
        );
        put(&mut text, 1, "</sensor>");
        put(&mut text, 0, "</mujoco>");
        text
    }
}

fn put(text: &mut String, depth: usize, line: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}{line}", "  ".repeat(depth));
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// The share of the load side: of inertia and of friction.
fn load(model: &Model) -> (f64, f64) {
    model
        .device
        .mechanics
        .link
        .map_or((1.0, 0.0), |link| (link.load_share, link.load_friction))
}

/// Level of the dry friction that is the same either way.
fn level(model: &Model) -> f64 {
    let [forward, backward] = model.device.mechanics.friction.level_nm;
    f64::midpoint(forward, backward)
}

fn world(text: &mut String, model: &Model) {
    let mechanics = &model.device.mechanics;
    let (load_share, load_friction) = load(model);
    let own = 1.0 - load_friction;
    let load_inertia = load_share * mechanics.inertia;
    let pendulum = Pendulum::of(&model.device, load_inertia);
    let body = BODY_SHARE * load_inertia;
    let kind = if model.is_linear { "slide" } else { "hinge" };
    // The lever hangs down, turned by where it hangs, about an axis that points to the viewer of x and z.
    let axis = if model.is_linear { "1 0 0" } else { "0 -1 0" };
    let (sin, cos) = pendulum.hangs_at.sin_cos();
    let motor_inertia = (1.0 - load_share) * mechanics.inertia;
    let armature = match (mechanics.link.is_some(), model.is_linear) {
        (true, _) => motor_inertia,
        (false, true) => 0.0,
        (false, false) => pendulum.rest - body,
    };
    let range = match stopped(model) {
        Some(range) if mechanics.link.is_none() => format!(" {range}"),
        _ => String::new(),
    };
    put(text, 1, "<worldbody>");
    put(text, 2, "<body name=\"paddle\">");
    let damping = poly(&[own * mechanics.viscous, mechanics.drag]);
    put(
        text,
        3,
        &format!(
            "<joint name=\"axis\" type=\"{kind}\" axis=\"{axis}\" armature=\"{}\" damping=\"{damping}\" frictionloss=\"{}\" {FRICTION}{range}/>",
            number(armature),
            number(own * level(model)),
        ),
    );
    if let Some(link) = mechanics.link {
        let armature = number(BODY_SHARE * load_inertia);
        // Both sides move against each other.
        let reduced = load_inertia * motor_inertia / (load_inertia + motor_inertia);
        let flanks = if link.play > 0.0 {
            let half = link.play / 2.0;
            contact([-half, half], link.stiffness, link.damping, reduced)
        } else {
            let [stiffness, damping] = [link.stiffness, link.damping].map(number);
            format!("stiffness=\"{stiffness}\" damping=\"{damping}\"")
        };
        put(
            text,
            3,
            &format!(
                "<joint name=\"twist\" type=\"{kind}\" axis=\"{axis}\" armature=\"{armature}\" {flanks}/>"
            ),
        );
    }
    if model.is_linear {
        put(
            text,
            3,
            &format!(
                "<inertial pos=\"0 0 0\" mass=\"{}\" diaginertia=\"1 1 1\"/>",
                number(load_inertia)
            ),
        );
    } else {
        let rest = if mechanics.link.is_some() {
            pendulum.rest
        } else {
            body
        };
        put(
            text,
            3,
            &format!(
                "<inertial pos=\"{} 0 {}\" mass=\"{}\" diaginertia=\"{rest:?} {rest:?} {rest:?}\"/>",
                number(-pendulum.lever_m * sin),
                number(-pendulum.lever_m * cos),
                number(pendulum.mass_kg),
            ),
        );
    }
    put(text, 2, "</body>");
    put(text, 1, "</worldbody>");
}

/// The range of a joint whose ends are springs with dampers that push and never pull.
///
/// MuJoCo's limit makes the acceleration `(1 - d) a + d (-b v - k r)` of the one without it, `a`. With an impedance d next to
/// nothing, and `k` and `b` that many times what the spring over the inertia is, it is the spring.
fn contact([low, high]: [f64; 2], stiffness: f64, damping: f64, inertia: f64) -> String {
    // Two numbers of which none is above 0 are stiffness and damping over the inertia; MuJoCo divides them by d itself.
    const LEAST: f64 = 1e-9;
    let direct = |value: f64| number(-(value / inertia).max(LEAST));
    format!(
        "range=\"{} {}\" solreflimit=\"{} {}\" solimplimit=\"{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2\"",
        number(low),
        number(high),
        direct(stiffness),
        direct(damping)
    )
}

/// Smallest time constant of a limit that is a spring: MuJoCo takes none below 0.0001.
const IMPEDANCE: f64 = 0.001;

/// The range of the load side between the stops, if there are any.
fn stopped(model: &Model) -> Option<String> {
    let [lower, upper] = stops(&model.device);
    let either = upper.or(lower)?;
    let inertia = load(model).0 * model.device.mechanics.inertia;
    let range = [
        lower.map_or(-FAR, |stop| stop.at),
        upper.map_or(FAR, |stop| stop.at),
    ];
    Some(contact(range, either.stiffness, either.damping, inertia))
}

/// Numbers of a polynomial, without zeros at its end.
fn poly(numbers: &[f64]) -> String {
    let last = numbers.iter().rposition(|value| *value != 0.0).unwrap_or(0);
    numbers[..=last]
        .iter()
        .map(|value| number(*value))
        .collect::<Vec<_>>()
        .join(" ")
}

fn tendons(text: &mut String, model: &Model) {
    let device = &model.device;
    let mechanics = &device.mechanics;
    let (_, load_friction) = load(model);
    let of_load = |text: &mut String, attributes: &str, gain: f64, has_twist: bool| {
        put(text, 2, &format!("<fixed {attributes}>"));
        put(
            text,
            3,
            &format!("<joint joint=\"axis\" coef=\"{}\"/>", number(gain)),
        );
        if has_twist {
            put(
                text,
                3,
                &format!("<joint joint=\"twist\" coef=\"{}\"/>", number(gain)),
            );
        }
        put(text, 2, "</fixed>");
    };
    let has_link = mechanics.link.is_some();
    let shows_load = mechanics.link.is_some_and(|link| link.sensor_on_load);
    put(text, 1, "<tendon>");
    of_load(text, "name=\"position\"", device.sensing.gain, shows_load);
    if load_friction > 0.0 {
        let attributes = format!(
            "name=\"bearing\" damping=\"{}\" frictionloss=\"{}\" {FRICTION}",
            number(load_friction * mechanics.viscous),
            number(load_friction * level(model))
        );
        of_load(text, &attributes, 1.0, true);
    }
    if mechanics.stiffness != 0.0 {
        let stiffness = poly(&[
            mechanics.stiffness,
            0.0,
            mechanics.stiffness * mechanics.hardening,
        ]);
        let at = number(mechanics.stiffness_zero);
        of_load(
            text,
            &format!("name=\"spring\" stiffness=\"{stiffness}\" springlength=\"{at} {at}\""),
            1.0,
            has_link,
        );
    }
    if let Some(range) = stopped(model).filter(|_| has_link) {
        of_load(text, &format!("name=\"stops\" {range}"), 1.0, true);
    }
    put(text, 1, "</tendon>");
}

fn actuators(text: &mut String, model: &Model) {
    let device = &model.device;
    let drive = &device.drive;
    let mut attributes = format!(
        "name=\"input\" joint=\"axis\" gear=\"{}\"",
        number(drive.ratio)
    );
    let limit = limit(device);
    if limit.is_finite() {
        attributes += &format!(" ctrlrange=\"-{limit:?} {limit:?}\"");
    }
    if drive.lag_s > 0.0 {
        attributes += &format!(
            " dyntype=\"filterexact\" dynprm=\"{}\"",
            number(drive.lag_s)
        );
    }
    if drive.delay_s > 0.0 {
        // The input of the last step before then: half a step sooner is the nearest step. Since MuJoCo 3.4.
        let sooner = (drive.delay_s - TIMESTEP_S / 2.0).max(TIMESTEP_S / 2.0);
        // Twice as many samples as steps fit into the delay, for steps of half the length.
        let samples = 2.0 * (drive.delay_s / TIMESTEP_S).ceil() + 2.0;
        attributes += &format!(
            " delay=\"{}\" nsample=\"{samples}\" interp=\"zoh\"",
            number(sooner)
        );
    }
    put(text, 1, "<actuator>");
    put(text, 2, &format!("<general {attributes}/>"));
    let [forward, backward] = device.mechanics.friction.level_nm;
    // A dry friction of two levels is one of their mean and a constant torque.
    let constant = device.mechanics.offset_nm - (forward - backward) / 2.0;
    if constant != 0.0 {
        put(
            text,
            2,
            &format!(
                "<general name=\"constant_torque\" joint=\"axis\" gainprm=\"0\" biastype=\"affine\" biasprm=\"{} 0 0\"/>",
                number(constant)
            ),
        );
    }
    put(text, 1, "</actuator>");
}
