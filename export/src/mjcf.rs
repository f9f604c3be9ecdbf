//! The XML format of MuJoCo (<https://mujoco.readthedocs.io/en/stable/XMLreference.html>), version 3 and later.

use crate::model::Model;
use crate::part::Part;
use crate::part::{limit, stops};
use crate::pendulum::{GRAVITY_M_S2, Pendulum};
use crate::writer::{Writer, number};
use std::fmt::Write;

/// Time step of the simulation, s. It is short enough for sticking friction.
const TIMESTEP_S: f64 = 1e-4;
/// Share of an inertia that is given to the body, because a body must have one.
const BODY_SHARE: f64 = 1e-3;

/// Parameters of the dry friction: it stops a motion within one step. MuJoCo decays the velocity with the rate 2 over the
/// time constant. It limits the time constant to at least two steps, so this value means two steps of any length.
const FRICTION: &str = "solreffriction=\"2e-05 1\" solimpfriction=\"0.9999 0.9999 0.001 0.5 2\"";
/// Position of a stop that is never reached, in units of position.
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
    // Writing to a `String` cannot fail.
    let _ = writeln!(text, "{}{line}", "  ".repeat(depth));
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// Shares of the load side in inertia and friction.
fn load(model: &Model) -> (f64, f64) {
    model
        .device
        .mechanics
        .link
        .map_or((1.0, 0.0), |link| (link.load_share, link.load_friction))
}

/// The part of the dry friction that is equal in both directions.
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
    // The lever hangs down, turned by its hanging angle, around an axis that points to the viewer of the x-z plane.
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
        // Both sides move relative to each other.
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

/// The range of a joint with spring-damper ends that push and never pull.
///
/// MuJoCo's limit gives the acceleration `(1 - d) a + d (-b v - k r)`, where `a` is the acceleration without it. With an
/// impedance d close to zero, and with d k and d b equal to stiffness and damping over the inertia, the limit acts as a
/// spring and damper.
fn contact([low, high]: [f64; 2], stiffness: f64, damping: f64, inertia: f64) -> String {
    // Two non-positive numbers are stiffness and damping over the inertia. MuJoCo divides them by d itself.
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

/// Impedance d of a limit that acts as a spring. MuJoCo's least value is 0.0001.
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

/// Coefficients of a polynomial without trailing zeros.
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
        // The delayed input is that of the last step before the delay. Half a step less selects the nearest step. This needs
        // MuJoCo 3.4 or later.
        let sooner = (drive.delay_s - TIMESTEP_S / 2.0).max(TIMESTEP_S / 2.0);
        // Twice as many samples as steps fit into the delay, so that the step may be halved.
        let samples = 2.0 * (drive.delay_s / TIMESTEP_S).ceil() + 2.0;
        attributes += &format!(
            " delay=\"{}\" nsample=\"{samples}\" interp=\"zoh\"",
            number(sooner)
        );
    }
    put(text, 1, "<actuator>");
    put(text, 2, &format!("<general {attributes}/>"));
    let [forward, backward] = device.mechanics.friction.level_nm;
    // Dry friction with two levels equals friction with their mean plus a constant torque.
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
