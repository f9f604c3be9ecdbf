//! Inertia and what pulls at it.

use super::{Form, Seen, linear, screened, with};
use crate::missing_torque::path::{Path, sign};
use host_sim::plant::Mechanics;

/// How far from the end of the motion a stop begins, over half of the span.
const STOPS: [f64; 11] = [
    0.003, 0.006, 0.012, 0.02, 0.03, 0.045, 0.07, 0.11, 0.18, 0.3, 0.5,
];
/// Half of the play, over half of the span.
const PLAYS: [f64; 5] = [0.006, 0.014, 0.03, 0.06, 0.12];
/// Resonance of a transmission that twists, over the rate of the motion: lowest and highest, and how many are tried by equal
/// ratios; those that explain most become forms. And its damping.
const RESONANCES: [f64; 2] = [1.5, 40.0];
const RESONANCES_TRIED: usize = 70;
const RESONANCES_KEPT: usize = 2;
const DAMPING: f64 = 0.03;

pub(super) fn inertia(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    // J' a = T, so that J a − T = (J/J' − 1) T.
    let stated = path.device.mechanics.inertia;
    let column = path.torque(path.device);
    vec![Form::new(vec![column], move |c| {
        vec![stated / (1.0 + c[0]).max(0.05)]
    })]
}

pub(super) fn gravity(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let m = &path.device.mechanics;
    if path.device.mechanics.angle_rad == 0.0 {
        return Vec::new();
    }
    let step = 0.2 * path.scale.torque;
    let mut forms = Vec::new();
    if m.gravity != 0.0 {
        let base = [m.gravity, m.gravity_zero];
        forms.push(linear(path, "gravity", &base, &[(0, step)]));
    }
    let angle = m.angle_rad;
    let of = |f: fn(f64) -> f64| -> Vec<f64> {
        path.position.iter().map(|x| step * f(angle * x)).collect()
    };
    let columns = vec![of(|a| -a.sin()), of(f64::cos)];
    let (weight, zero) = (m.gravity, angle * m.gravity_zero);
    forms.push(Form::new(columns, move |c| {
        let across = weight * zero.cos() + c[0] * step;
        let along = weight * zero.sin() + c[1] * step;
        vec![across.hypot(along), along.atan2(across) / angle]
    }));
    forms
}

pub(super) fn spring(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let m = &path.device.mechanics;
    let (half, middle) = (path.scale.half_span(), path.scale.middle());
    let step = 0.2 * path.scale.torque;
    let away = |power: i32| -> Vec<f64> {
        let positions = path.position.iter();
        positions
            .map(|x| -step * ((x - middle) / half).powi(power))
            .collect()
    };
    let constant = vec![step; path.position.len()];
    let (stiffness, zero) = (m.stiffness, m.stiffness_zero);
    let values = move |c: &[f64]| {
        let pull = stiffness + c[0] * step / half;
        let offset = stiffness * (zero - middle) + c[1] * step;
        let hardening = c.get(2).map_or(0.0, |c| c * step / half.powi(3) / pull);
        vec![pull, middle + offset / pull, hardening]
    };
    vec![
        Form::new(vec![away(1), constant.clone()], values),
        Form::new(vec![away(1), constant, away(3)], values),
    ]
}

pub(super) fn end_stop(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let half = path.scale.half_span();
    let [low, high] = path.scale.reach;
    let mut forms = Vec::new();
    for side in [-1.0, 1.0] {
        for part in STOPS {
            let at = if side > 0.0 { high } else { low } - side * part * half;
            let depth = |i: usize| side * (path.position[i] - at);
            let steps = 0..path.position.len();
            let push = steps
                .clone()
                .map(|i| -side * depth(i).max(0.0) / (part * half));
            let damp = steps.map(|i| {
                if depth(i) > 0.0 {
                    -path.velocity[i] / path.scale.velocity
                } else {
                    0.0
                }
            });
            let columns = vec![push.collect(), damp.collect()];
            let (per_way, per_speed) = (part * half, path.scale.velocity);
            let far = 100.0 * half;
            let [lower, upper] = if side > 0.0 {
                [low - far, at]
            } else {
                [at, high + far]
            };
            let form = Form::new(columns, move |c| {
                let (k, d) = (c[0].max(0.0) / per_way, c[1].max(0.0) / per_speed);
                vec![lower, upper, k, d]
            });
            forms.push(form.searched(2).seldom().positive());
        }
    }
    let mut forms = screened(seen, forms, 3);
    if path.device.mechanics.barriers.iter().any(Option::is_some) {
        let mut free = path.device.clone();
        free.mechanics.barriers = Mechanics::inertia(1.0).barriers;
        let far = half;
        let values = move |_: &[f64]| with("end_stop", &[(0, low - far), (1, high + far)]);
        forms.push(Form::new(vec![path.on_top(&free)], values).positive());
    }
    forms
}

/// Torque that a rigid transmission carries to a load with all of the inertia, per step.
fn carried(path: &Path<'_>) -> Vec<f64> {
    let m = &path.device.mechanics;
    let net = path.torque(path.device);
    let steps = net.iter().enumerate();
    steps
        .map(|(i, net)| {
            let level = m.friction.level(path.direction[i]);
            net + m.viscous * path.velocity[i] + level * path.direction[i]
        })
        .collect()
}

/// While the play is passed, the load no longer takes its part of the torque; where it ends, the load strikes.
pub(super) fn backlash(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let carried = carried(path);
    let inertia = path.device.mechanics.inertia;
    let forms = PLAYS.iter().map(|part| {
        let half_play = part * path.scale.half_span();
        // Side on which the load lies, way of the motor since it left, and velocity of the load then.
        let (mut side, mut passed, mut speed, mut free) = (0.0, 0.0, 0.0, false);
        let n = carried.len();
        let [mut floats, mut strikes] = [vec![0.0; n], vec![0.0; n]];
        for i in 0..n {
            let step_s = path.samples.step_s[i];
            if step_s == 0.0 {
                (free, side) = (false, 0.0);
                continue;
            }
            let pushes = sign(carried[i]);
            if !free {
                if side == 0.0 {
                    side = pushes;
                }
                if pushes == side || pushes == 0.0 {
                    continue;
                }
                (free, passed, speed) = (true, 0.0, path.velocity[i]);
            }
            passed -= side * (path.velocity[i] - speed) * step_s;
            let crossed = passed >= 2.0 * half_play;
            if crossed || passed < -0.5 * half_play {
                strikes[i] = -inertia * (path.velocity[i] - speed) / step_s;
                free = false;
                if crossed {
                    side = -side;
                }
            } else {
                floats[i] = carried[i];
            }
        }
        let values = move |c: &[f64]| {
            let share = (0.5 + c[0].abs().min(1.0) * 0.2).clamp(0.1, 0.9);
            with("backlash", &[(0, 2.0 * half_play), (1, share)])
        };
        Form::new(vec![floats, strikes], values).searched(1)
    });
    forms.collect()
}

/// What of a torque is above a resonance, per step.
fn above_resonance(path: &Path<'_>, torque: &[f64], rate: f64) -> Vec<f64> {
    let (mut y, mut w) = (0.0, 0.0);
    let steps = torque.iter().zip(&path.samples.step_s);
    let above = steps.map(|(torque, &step_s)| {
        if step_s == 0.0 {
            (y, w) = (0.0, 0.0);
            return 0.0;
        }
        // In parts of at most a fifth of a radian.
        let count = (5.0 * rate * step_s).ceil().max(1.0);
        let t = step_s / count;
        for _ in 0..count as usize {
            w += t * (rate * rate * (torque - y) - 2.0 * DAMPING * rate * w);
            y += t * w;
        }
        torque - y
    });
    above.collect()
}

/// The masses swing against each other: of two masses and a spring between them, `J s² x/T − 1` is `s²/(s² + ω²)` times the ratio
/// of the masses on the motor's side, and −1 times that on the load's.
pub(super) fn compliance(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let carried = carried(path);
    let inertia = path.device.mechanics.inertia;
    let [lowest, highest] = RESONANCES.map(|part| part * path.scale.rate());
    // The smoother does not follow faster ones.
    let highest = highest.min(seen.corner).max(1.1 * lowest);
    let ratio = (highest / lowest).powf(1.0 / (RESONANCES_TRIED - 1) as f64);
    let tried = (0..RESONANCES_TRIED).map(|k| {
        let rate = lowest * ratio.powi(k as i32);
        let column = above_resonance(path, &carried, rate);
        (seen.explained(core::slice::from_ref(&column)), rate, column)
    });
    let mut tried: Vec<(f64, f64, Vec<f64>)> = tried.collect();
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    tried.truncate(RESONANCES_KEPT);
    let forms = tried.into_iter().map(|(_, rate, column)| {
        Form::new(vec![column], move |c| {
            let load = if c[0] > 0.0 { c[0] / (1.0 + c[0]) } else { 0.5 };
            let load = load.clamp(0.1, 0.9);
            let stiffness = load * (1.0 - load) * inertia * rate * rate;
            with("compliance", &[(0, stiffness), (2, load)])
        })
        .searched(1)
    });
    forms.collect()
}
