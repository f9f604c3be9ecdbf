//! From the input to the torque.

use super::{Form, Seen, linear, on_top, screened, whole, with};
use crate::missing_torque::path::Path;

/// Parts of the largest input up to which nothing happens, and from which on it is clipped.
const DEAD: [f64; 8] = [0.03, 0.06, 0.1, 0.15, 0.21, 0.28, 0.36, 0.46];
const CLIPPED: [f64; 8] = [0.92, 0.84, 0.76, 0.67, 0.58, 0.49, 0.4, 0.3];
/// A limit of the model that is too low, over it.
const BEYOND: [f64; 3] = [1.15, 1.5, 2.2];
/// Times by which the torque is late, over the time of a radian of the motion.
const LATE: [f64; 4] = [0.03, 0.1, 0.25, 0.6];

pub(super) fn torque_gain(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    vec![linear(path, "torque_gain", &[1.0], &[(0, 0.3)])]
}

pub(super) fn torque_offset(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let offset = path.device.mechanics.offset_nm;
    let step = 0.2 * path.scale.torque;
    vec![linear(path, "torque_offset", &[offset], &[(0, step)])]
}

pub(super) fn deadband(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let widths = DEAD.iter().map(|part| part * path.scale.input);
    let forms = widths.flat_map(|width| {
        // The torque starts from zero beyond it, or with all of the input.
        [(0.0, Some(0)), (1.0, None)].map(|(jump, size)| {
            let values = with("deadband", &[(0, width), (1, jump)]);
            whole(path, "deadband", values, size).positive()
        })
    });
    screened(seen, forms.collect(), 2)
}

pub(super) fn saturation(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let limit = path.device.drive.limit;
    let reached = path.scale.input.min(limit);
    let lower = CLIPPED.iter().map(|part| part * reached);
    let higher = BEYOND.iter().map(|part| part * limit);
    let higher = higher.filter(|_| limit < path.scale.input);
    let limits = lower.chain(higher);
    let forms = limits.flat_map(|limit| {
        [0.0, 0.5].map(|knee| {
            let values = with("saturation", &[(0, limit), (1, knee), (2, 0.0)]);
            whole(path, "saturation", values, None).positive()
        })
    });
    screened(seen, forms.collect(), 2)
}

/// The form of an effect whose first number is a time by which something is later than stated, or sooner, down to not at all.
pub(super) fn late(
    path: &Path<'_>,
    seen: &Seen<'_>,
    name: &'static str,
    stated_s: f64,
) -> Vec<Form> {
    let column = |late_s: f64| on_top(path, name, &with(name, &[(0, stated_s + late_s)]));
    let times = LATE.iter().map(|part| part / path.scale.rate());
    let times = times.flat_map(|late_s| [late_s, -late_s.min(stated_s)]);
    let tried = times.filter(|late_s| *late_s != 0.0).map(|late_s| {
        let torque = column(late_s);
        (
            seen.explained(core::slice::from_ref(&torque)),
            late_s,
            torque,
        )
    });
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0));
    let form = best.map(|(_, mut late_s, mut torque)| {
        // Twice to where the coefficient is 1: being late is not proportional to the time.
        for _ in 0..2 {
            late_s *= seen.coefficient(&torque).clamp(0.3, 3.0);
            late_s = late_s.max(-stated_s);
            torque = column(late_s);
        }
        Form::new(vec![torque], move |c| {
            with(name, &[(0, (stated_s + c[0] * late_s).max(0.0))])
        })
        .searched(1)
        .positive()
    });
    form.into_iter().collect()
}

pub(super) fn lag(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let stated_s = path.device.drive.lag_s;
    let mut forms = late(path, seen, "lag", stated_s);
    if stated_s == 0.0 {
        let twice = LATE.iter().map(|part| {
            let values = with("lag", &[(0, part / path.scale.rate()), (1, 1.0)]);
            whole(path, "lag", values, Some(0)).positive()
        });
        forms.extend(screened(seen, twice.collect(), 1));
    }
    forms
}

pub(super) fn delay(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    late(path, seen, "delay", path.device.drive.delay_s)
}

pub(super) fn cogging(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let forms = seen.waves.strongest.iter().map(|&wave_number| {
        let wave = |shift: f64| -> Vec<f64> {
            let positions = path.position.iter();
            positions.map(|x| (wave_number * x + shift).sin()).collect()
        };
        let columns = vec![wave(0.0), wave(core::f64::consts::FRAC_PI_2)];
        Form::new(columns, move |c| {
            let phase = c[1].atan2(c[0]);
            with(
                "cogging",
                &[(0, c[0].hypot(c[1])), (1, wave_number), (2, phase)],
            )
        })
        .searched(1)
    });
    forms.collect()
}
