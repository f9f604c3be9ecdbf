//! What lies between the position and its reading.
//!
//! A reading y = s(x) of a position x moves as if the torque `s'(x) T(x) + J s''(x) v² − T(y)` were missing, where T is
//! what the device itself does.

use super::{Form, Seen, actuation, with};
use crate::missing_torque::path::{Moment, Path, sign, torque};
use core::f64::consts::FRAC_PI_2;

/// Size of an error for a unit of its coefficient, over half of the span.
const STEP: f64 = 0.1;
/// Speeds beyond which counts are lost, over the rms one.
const LOSES: [f64; 6] = [0.3, 0.5, 0.7, 0.9, 1.15, 1.45];
/// Half of the play of a reading, over half of the span.
const HALF_PLAYS: [f64; 7] = [0.005, 0.01, 0.02, 0.035, 0.06, 0.1, 0.16];
/// Jumps of the counter that are looked for.
const JUMPS: usize = 3;

/// The torque that seems to be missing where the reading is off by `error(x)`, with its first two derivatives.
fn misread(path: &Path<'_>, error: impl Fn(f64) -> [f64; 3]) -> Vec<f64> {
    let m = &path.device.mechanics;
    let steps = (0..path.position.len()).map(|i| {
        let shown = path.at(i);
        let [e, slope, bend] = error(shown.position);
        let is = Moment {
            position: shown.position - e,
            velocity: shown.velocity / (1.0 + slope),
            ..shown
        };
        let drive = path.drive[i];
        (1.0 + slope) * torque(m, drive, &is) + m.inertia * bend * is.velocity * is.velocity
            - torque(m, drive, &shown)
    });
    steps.collect()
}

pub(super) fn sensor_gain(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let gain = misread(path, |x| [STEP * x, STEP, 0.0]);
    let alone = Form::new(vec![gain.clone()], |c| {
        with("sensor_gain", &[(0, (1.0 + STEP * c[0]).max(0.1))])
    });
    if !path.device.mechanics.is_pulled() {
        return vec![alone];
    }
    // It may read right elsewhere than at zero.
    let half = path.scale.half_span();
    let shift = misread(path, |_| [STEP * half, 0.0, 0.0]);
    let elsewhere = Form::new(vec![gain, shift], move |c| {
        let right_at = if c[0] == 0.0 {
            0.0
        } else {
            -c[1] * half / c[0]
        };
        with(
            "sensor_gain",
            &[(0, (1.0 + STEP * c[0]).max(0.1)), (1, right_at)],
        )
    });
    vec![alone, elsewhere]
}

pub(super) fn sensor_nonlinearity(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let name = "sensor_nonlinearity";
    let (half, middle) = (path.scale.half_span(), path.scale.middle());
    let bent = |power: i32| {
        misread(path, |x| {
            let z = (x - middle) / half;
            let n = f64::from(power);
            let bend = n * (n - 1.0) * z.powi(power - 2) / half;
            [
                STEP * half * z.powi(power),
                STEP * n * z.powi(power - 1),
                STEP * bend,
            ]
        })
    };
    let square = move |c: &[f64]| with(name, &[(0, STEP * c[0] / half), (1, 0.0), (6, middle)]);
    let cube = move |c: &[f64]| {
        with(
            name,
            &[(0, 0.0), (1, STEP * c[0] / (half * half)), (6, middle)],
        )
    };
    let mut forms = vec![
        Form::new(vec![bent(2)], square),
        Form::new(vec![bent(3)], cube),
    ];
    for &n in &seen.waves.of_reading {
        let wave = |shift: f64| {
            misread(path, |x| {
                let (sin, cos) = (n * x + shift).sin_cos();
                // As steep as a gain of that size would be.
                [STEP * sin / n, STEP * cos, -STEP * n * sin]
            })
        };
        let columns = vec![wave(0.0), wave(FRAC_PI_2)];
        let form = Form::new(columns, move |c| {
            let [sine, cosine] = [c[0], c[1]].map(|c| STEP * c / n);
            with(name, &[(0, 0.0), (2, sine), (3, cosine), (4, n)])
        });
        forms.push(form.searched(1));
    }
    forms
}

/// The reading stays behind by half of the play. At a reversal it rests until the position has crossed the play, as the device
/// itself says how fast it does, and is then suddenly as fast as the position.
pub(super) fn sensor_hysteresis(path: &Path<'_>, _: &Seen<'_>) -> Vec<Form> {
    let plays = HALF_PLAYS.iter().map(|part| part * path.scale.half_span());
    plays.map(|half| behind(path, half)).collect()
}

fn behind(path: &Path<'_>, half: f64) -> Form {
    let m = &path.device.mechanics;
    let n = path.position.len();
    let mut reading = vec![0.0; n];
    let mut torques = vec![0.0; n];
    // Side to which the reading is off, and way and velocity of the position since the reading rests.
    let (mut side, mut way, mut speed) = (0.0, 0.0, 0.0);
    for i in 0..n {
        let shown = path.at(i);
        let step_s = path.samples.step_s[i];
        if shown.slides && shown.direction.abs() == 1.0 {
            side = -shown.direction;
            (way, speed) = (0.0, shown.velocity);
            reading[i] = half * side;
        } else {
            let is = Moment {
                velocity: speed,
                direction: sign(speed),
                slides: speed != 0.0,
                ..shown
            };
            let acceleration = torque(m, path.drive[i], &is) / m.inertia;
            speed += acceleration * step_s;
            way = (way + speed * side * step_s).clamp(0.0, 2.0 * half);
            // On the old side the position goes on; then it comes back through the play.
            reading[i] = side * (half - way);
        }
        let is = Moment {
            position: shown.position - reading[i],
            ..shown
        };
        let is = if shown.slides {
            is
        } else {
            Moment {
                velocity: speed,
                direction: sign(speed),
                slides: speed != 0.0,
                ..is
            }
        };
        torques[i] = torque(m, path.drive[i], &is) - torque(m, path.drive[i], &shown);
        if step_s == 0.0 {
            (side, way, speed) = (0.0, 0.0, 0.0);
        }
    }
    Form {
        torque: vec![torques],
        reading: vec![reading],
        values: Box::new(move |c| with("sensor_hysteresis", &[(0, 2.0 * half * c[0].max(0.1))])),
        searched: 1,
        seldom: false,
        positive: true,
    }
}

/// As a drive that is late, with the friction as late as the drive.
pub(super) fn sensor_lag(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let late = actuation::late(path, seen, "lag", 0.0);
    let friction = &path.device.mechanics.friction;
    let held = |i: usize| friction.level(path.direction[i]) * path.direction[i];
    let last = path.samples.len().saturating_sub(1);
    let forms = late.into_iter().map(|form| {
        let late_s = (form.values)(&[1.0])[0];
        // The position is ahead of its reading, and so is its friction, of which the reading shows a lagging part.
        let rows_ahead = (late_s / path.samples.period_s) as usize;
        let mut lagging = 0.0;
        let mut column = form.torque[0].clone();
        for (i, torque) in column.iter_mut().enumerate() {
            let step_s = path.samples.step_s[i];
            if step_s == 0.0 {
                lagging = held(i);
                continue;
            }
            let passed = 1.0 - (-step_s / late_s).exp();
            lagging += passed * (held((i + rows_ahead).min(last)) - lagging);
            *torque -= lagging - held(i);
        }
        let values = move |c: &[f64]| with("sensor_lag", &[(0, (late_s * c[0]).max(0.0))]);
        Form::new(vec![column], values).searched(1).positive()
    });
    forms.collect()
}

pub(super) fn lost_counts(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let mut forms: Vec<Form> = LOSES
        .iter()
        .map(|part| slip(path, part * path.scale.velocity))
        .collect();
    forms.extend(jumps(path, seen));
    forms
}

/// Beyond a speed, a share of the way is lost: the reading goes slower, from there at once.
fn slip(path: &Path<'_>, beyond: f64) -> Form {
    let m = &path.device.mechanics;
    let net = path.torque(path.device);
    let mut before = None;
    let column = (0..net.len()).map(|i| {
        let v = path.velocity[i];
        let loses = f64::from(v.abs() > beyond);
        let step_s = path.samples.step_s[i];
        let began: f64 = match before {
            Some(before) if step_s > 0.0 => (loses - before) / step_s,
            _ => 0.0,
        };
        before = (step_s > 0.0).then_some(loses);
        -(loses * (net[i] + m.viscous * v) + m.inertia * v * began) * STEP
    });
    let column = column.collect();
    Form::new(vec![column], move |c| {
        let share = (STEP * c[0]).clamp(0.0, 1.0);
        with("lost_counts", &[(1, 0.0), (2, share), (3, beyond)])
    })
    .searched(1)
    .positive()
}

/// Jumps of the counter where the smoother is most surprised.
fn jumps(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let n = path.position.len();
    let mut order: Vec<usize> = (0..n).collect();
    let size = |i: usize| seen.innovation[i].abs();
    // The first rows of a stretch surprise anyway.
    for stretch in &path.samples.stretches {
        let first = stretch.rows.start..(stretch.rows.start + 10).min(stretch.rows.end);
        order.retain(|row| !first.contains(row));
    }
    let mut found: Vec<usize> = Vec::new();
    while found.len() < JUMPS {
        let far = |row: usize| found.iter().all(|f: &usize| f.abs_diff(row) > 20);
        let next = order.iter().copied().filter(|&row| far(row));
        let Some(row) = next.max_by(|a, b| size(*a).total_cmp(&size(*b))) else {
            break;
        };
        found.push(row);
    }
    let unit = 0.1 * path.scale.half_span();
    let column = |row: usize| -> Vec<f64> {
        let end = path
            .samples
            .stretches
            .iter()
            .find(|s| s.rows.contains(&row));
        let end = end.map_or(n, |s| s.rows.end);
        let rows = 0..n;
        rows.map(|i| if (row..end).contains(&i) { unit } else { 0.0 })
            .collect()
    };
    let forms = (1..=found.len()).map(|count| {
        let rows = &found[..count];
        let reading: Vec<Vec<f64>> = rows.iter().map(|&row| column(row)).collect();
        let at_s: Vec<f64> = rows
            .iter()
            .map(|&row| path.samples.session_s[row])
            .collect();
        Form {
            torque: vec![vec![0.0; n]; count],
            reading,
            values: Box::new(move |c| {
                let mut values = with("lost_counts", &[(0, at_s[0]), (1, unit * c[0]), (2, 0.0)]);
                for (at_s, c) in at_s.iter().zip(c).skip(1) {
                    values.extend([*at_s, unit * c]);
                }
                values
            }),
            searched: count,
            seldom: true,
            positive: false,
        }
    });
    forms.collect()
}
