//! What is outside the device and comes and goes.

use super::{Form, Seen, screened, with};
use crate::missing_torque::path::Path;

/// Where what pushes begins, between the ends of the motion while it is there.
const PLACES: [f64; 9] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85];

/// Something outside that pushes back or holds in the time in which most is missing.
pub(super) fn contact(path: &Path<'_>, seen: &Seen<'_>) -> Vec<Form> {
    let Some((first, last)) = most_missing(path, seen) else {
        return Vec::new();
    };
    let rows = first..last + 1;
    let inside = |i: usize| rows.contains(&i);
    let [from_s, to_s] = [first, last].map(|row| path.samples.session_s[row]);
    let ends = path.position[rows.clone()].iter();
    let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| {
        [l.min(*x), h.max(*x)]
    });
    let span = (high - low).max(f64::MIN_POSITIVE);
    let speed = path.scale.velocity;
    let n = path.position.len();
    let mut forms = Vec::new();
    let middle = 0.5 * (low + high);
    let of = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..n).map(|i| if inside(i) { f(i) } else { 0.0 }).collect()
    };
    let holds = vec![
        of(&|i| -(path.position[i] - middle) / span),
        of(&|i| -path.velocity[i] / speed),
        of(&|_| 1.0),
    ];
    forms.push(
        Form::new(holds, move |c| {
            let k = c[0] / span;
            let at = middle + c[2] / k;
            with(
                "contact",
                &[
                    (0, k.max(0.0)),
                    (1, (c[1] / speed).max(0.0)),
                    (2, 0.0),
                    (3, at),
                    (4, from_s),
                    (5, to_s),
                ],
            )
        })
        .searched(4)
        .seldom(),
    );
    for side in [-1.0, 1.0] {
        for part in PLACES {
            let at = low + part * span;
            let depth = |i: usize| side * (path.position[i] - at);
            let push = of(&|i| -side * depth(i).max(0.0) / span);
            let damp = of(&|i| {
                if depth(i) > 0.0 {
                    -path.velocity[i] / speed
                } else {
                    0.0
                }
            });
            let form = Form::new(vec![push, damp], move |c| {
                let (k, d) = ((c[0] / span).max(0.0), (c[1] / speed).max(0.0));
                with(
                    "contact",
                    &[(0, k), (1, d), (2, side), (3, at), (4, from_s), (5, to_s)],
                )
            });
            forms.push(form.searched(5).seldom().positive());
        }
    }
    screened(seen, forms, 2)
}

/// First and last row of the stretch of time in which most more is missing than on the average.
fn most_missing(path: &Path<'_>, seen: &Seen<'_>) -> Option<(usize, usize)> {
    let energy = |i: usize| seen.weight[i] * (seen.torque[i].powi(2));
    let energy = |i: usize| energy(i).sqrt();
    let rows = 0..path.samples.len();
    let weighed: f64 = seen.weight.iter().map(|w| w.sqrt()).sum();
    let mean = rows.map(energy).sum::<f64>() / weighed.max(f64::MIN_POSITIVE);
    let mut best: Option<(f64, usize, usize)> = None;
    for stretch in &path.samples.stretches {
        let (mut sum, mut from) = (0.0, stretch.rows.start);
        for row in stretch.rows.clone() {
            if sum <= 0.0 {
                (sum, from) = (0.0, row);
            }
            // Twice the mean, so that what is usual does not add up.
            sum += energy(row) - 2.0 * mean * seen.weight[row].sqrt();
            if best.is_none_or(|(most, ..)| sum > most) {
                best = Some((sum, from, row));
            }
        }
    }
    best.filter(|(sum, from, to)| *sum > 0.0 && to > from)
        .map(|(_, from, to)| (from, to))
}
