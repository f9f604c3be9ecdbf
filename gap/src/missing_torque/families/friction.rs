//! What resists motion.

use super::{Form, Seen, linear, screened, with};
use crate::missing_torque::path::{Path, sign};

/// Velocities over which static friction falls, over the rms one.
const FALLS: [f64; 6] = [0.02, 0.04, 0.08, 0.15, 0.3, 0.6];
/// How far bristles bend before they slide, over half of the span.
const BENDS: [f64; 8] = [0.004, 0.008, 0.015, 0.03, 0.055, 0.1, 0.16, 0.25];
/// Parts of the session after which a friction has settled or steps.
const SETTLES: [f64; 2] = [0.2, 0.5];
const STEPS: [f64; 13] = [
    0.15, 0.21, 0.27, 0.33, 0.39, 0.45, 0.51, 0.57, 0.63, 0.69, 0.75, 0.81, 0.87,
];
/// Places of a spot that rubs and its width, over half of the span.
const SPOTS: [f64; 7] = [-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75];
const SPOT_WIDTHS: [f64; 2] = [0.25, 0.5];
/// Part of the pull of gravity and springs that a friction may grow with beside that of the drive.
const PASSIVE: [f64; 3] = [0.0, 1.0, -1.0];
/// And how many times as much it rubs where the load drives.
const BACKDRIVEN: [f64; 2] = [1.0, 5.0];

fn level(path: &Path<'_>) -> f64 {
    path.device.mechanics.friction.highest_nm()
}

/// Torque of a step of a friction's level.
fn step(path: &Path<'_>) -> f64 {
    0.2 * path.scale.torque
}

pub(super) fn coulomb(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    vec![linear(path, "coulomb", &[level(path)], &[(0, step(path))])]
}

pub(super) fn asymmetric_coulomb(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let base = path.device.mechanics.friction.level_nm;
    let step = step(path);
    [&[(0, step)][..], &[(1, step)], &[(0, step), (1, step)]]
        .map(|steps| linear(path, "asymmetric_coulomb", &base, steps))
        .into()
}

pub(super) fn viscous(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let step = 0.1 * path.scale.torque / path.scale.velocity;
    vec![linear(
        path,
        "viscous",
        &[path.device.mechanics.viscous],
        &[(0, step)],
    )]
}

pub(super) fn quadratic_drag(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let step = 0.1 * path.scale.torque / path.scale.velocity.powi(2);
    vec![linear(
        path,
        "quadratic_drag",
        &[path.device.mechanics.drag],
        &[(0, step)],
    )]
}

pub(super) fn stribeck(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    if level(path) == 0.0 {
        return Vec::new();
    }
    let falls = FALLS.iter().flat_map(|part| {
        [1.0, 2.0].map(|exponent| {
            let velocity = part * path.scale.velocity;
            let base = with("stribeck", &[(0, 1.0), (1, velocity), (2, exponent)]);
            linear(path, "stribeck", &base, &[(0, 0.5)])
                .searched(1)
                .positive()
        })
    });
    screened(seen, falls.collect(), 2)
}

pub(super) fn presliding(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let levels = path.device.mechanics.friction.level_nm;
    if level(path) == 0.0 {
        return Vec::new();
    }
    let forms = BENDS.iter().map(|part| {
        let distance = part * path.scale.half_span();
        let mut bent = 0.0f64;
        let column = (0..path.position.len()).map(|i| {
            let step_s = path.samples.step_s[i];
            if step_s == 0.0 {
                bent = 0.0;
                return 0.0;
            }
            let passed = path.velocity[i] * step_s / distance;
            let before = bent;
            // Dahl's bristles: s' = x'(1 − s sgn x')/z, in one step.
            let way = sign(passed);
            bent = way + (bent - way) * (-passed.abs()).exp();
            let held = 0.5 * (before + bent);
            let full = if path.direction[i] < 0.0 {
                levels[1]
            } else {
                levels[0]
            };
            full * (path.direction[i] - held)
        });
        let column = column.collect();
        Form::new(vec![column], move |_| {
            with("presliding", &[(0, distance), (1, 0.0)])
        })
        .searched(1)
        .positive()
    });
    screened(seen, forms.collect(), 2)
}

pub(super) fn load_dependent_friction(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let name = "load_dependent_friction";
    let pulled = path.device.mechanics.is_pulled();
    let parts = PASSIVE.iter().filter(|part| pulled || **part == 0.0);
    let forms = parts.flat_map(|&part| {
        BACKDRIVEN.map(|times| linear(path, name, &[0.0, part, times], &[(0, 0.1)]).positive())
    });
    forms.collect()
}

pub(super) fn position_dependent_coulomb(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let name = "position_dependent_coulomb";
    if level(path) == 0.0 {
        return Vec::new();
    }
    let half = path.scale.half_span();
    let plain = with(name, &[(0, 0.0), (1, 0.0), (2, 1.0)]);
    let rise = [(0, 0.2 / half), (2, 0.2)];
    let bend = [(0, 0.2 / half), (1, 0.2 / (half * half)), (2, 0.2)];
    let mut forms = Vec::new();
    for &place in &SPOTS {
        for &width in &SPOT_WIDTHS {
            let at = path.scale.middle() + place * half;
            let base = with(
                name,
                &[(0, 0.0), (1, 0.0), (2, 1.0), (7, at), (8, width * half)],
            );
            forms.push(linear(path, name, &base, &[(6, 0.3)]).searched(2));
        }
    }
    for &wave_number in &seen.waves.resisting {
        let base = with(name, &[(0, 0.0), (1, 0.0), (2, 1.0), (5, wave_number)]);
        let steps = [(2, 0.2), (3, 0.2), (4, 0.2)];
        forms.push(linear(path, name, &base, &steps).searched(1));
    }
    let mut forms = screened(seen, forms, 2);
    forms.push(linear(path, name, &plain, &rise));
    forms.push(linear(path, name, &plain, &bend));
    forms
}

pub(super) fn friction_drift(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let name = "friction_drift";
    if level(path) == 0.0 {
        return Vec::new();
    }
    let [from_s, to_s] = path.scale.session_s;
    let lasts_s = (to_s - from_s).max(f64::MIN_POSITIVE);
    let base =
        |settling_s: f64, settled: f64| with(name, &[(0, 0.0), (1, settling_s), (3, settled)]);
    let mut forms = vec![linear(path, name, &base(0.0, 0.0), &[(0, 0.3 / lasts_s)])];
    for part in SETTLES {
        for settled in [0.0, 1.0] {
            let base = base(part * lasts_s, settled);
            forms.push(linear(path, name, &base, &[(0, 0.3 / (part * lasts_s))]).searched(1));
        }
    }
    for part in STEPS {
        let base = with(name, &[(0, 0.0), (1, 0.0), (5, from_s + part * lasts_s)]);
        forms.push(linear(path, name, &base, &[(4, 0.3)]).searched(1));
    }
    screened(seen, forms, 3)
}
