//! A reading that is bent over the position, or ripples with it.

use super::identification::Identification;
use super::phrase::Found;
use super::sensor_gain::SensorGain;
use crate::columns::{Disagreement, lowest};
use crate::guess::Evidence;
use crate::guess::regression::{Moment, moments};
use crate::guess::start::{linear, term};
use crate::guess::waves::Waves;
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::misreading::{STEP, misread};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use core::f64::consts::{FRAC_PI_2, TAU};
use host_sim::effects::Kind;
use host_sim::effects::sensor_nonlinearity::KIND;
use nalgebra::{Matrix2, Vector2};

/// Quadratic and cubic deviation of a curve at the ends of the motion, over half of its span.
const BENDS: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [0.2, 0.0],
    [-0.2, 0.0],
    [0.0, 0.3],
    [0.0, -0.15],
];
/// Places among the parameters of its cube, of the amplitudes of its ripple, and of the place around which it is bent.
const CUBIC: usize = 1;
const RIPPLE: [usize; 2] = [2, 3];
const MIDDLE: usize = 6;
/// Periods of a ripple over the span of the motion.
const RIPPLES: [f64; 3] = [0.5, 1.0, 2.0];
/// Periods over the span of the motion are tried at this spacing, up to so many.
const TURNS_APART: f64 = 0.25;
const MOST_TURNS: f64 = 150.0;
/// Number of samples for the search of ripples, number of wave numbers from which a fit starts, and slope of such a
/// ripple.
const MOST_MOMENTS: usize = 1500;
const PEAKS: usize = 2;
const MOST_SLOPE: f64 = 0.5;
/// Periods of a ripple between two columns, over the span of the motion.
const TURNS: [f64; 2] = [0.25, 4.0];

#[derive(Debug)]
pub(super) struct SensorNonlinearity;

impl Identification for SensorNonlinearity {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Bent curves, and the ripples of an eccentric disk or of poles, of which the motion passes one period or a few.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let reach = s.position[0].abs().max(s.position[1].abs());
        let middle = s.middle();
        // A curve that is right at zero, or in the middle of the motion.
        let bent = |middle: f64, reach: f64, [square, cube]: [f64; 2]| {
            let free = vec![
                linear(0, square / reach, 0.2 / reach),
                linear(1, cube / (reach * reach), 0.2 / (reach * reach)),
            ];
            term(&KIND, free, &[(MIDDLE, middle)])
        };
        let rippled = |turns: f64| {
            let wave_number = turns * TAU / s.span();
            let amplitude = 0.1 / wave_number;
            let waves = linear(4, wave_number, 0.2 * wave_number);
            ripple(e, [0.0, amplitude], amplitude, waves)
        };
        let mut all = vec![bent(0.0, reach, [0.0, 0.0])];
        all.extend(BENDS.map(|bend| bent(middle, 0.5 * s.span(), bend)));
        all.extend(RIPPLES.map(rippled));
        all.extend(ripples(e));
        all
    }

    fn further_shape(&self, fitted: &Term, half_span: f64) -> Vec<Coordinate> {
        let is_bent = fitted.is_free(CUBIC) && !fitted.is_free(MIDDLE);
        let middle = || linear(MIDDLE, fitted.values[MIDDLE], 0.2 * half_span);
        let middle = is_bent.then(middle);
        middle.into_iter().collect()
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&SensorGain]
    }

    /// A bent curve, and one with a ripple.
    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let r = columns.reach;
        let curve =
            |[a, b, s, c, n]: [f64; 5], o| vec![a / (r * r), b / r.powi(3), s, c, n, o, 0.0];
        let bent = columns.linear(|x| [(x / r).powi(2), (x / r).powi(3), 1.0]);
        let bent = bent.map(|[a, b, o]| curve([a, b, 0.0, 0.0, 1.0 / r], o));
        let rippled = |wave_number: f64| {
            columns
                .linear(|x| {
                    let (sin, cos) = (wave_number * x).sin_cos();
                    [(x / r).powi(2), (x / r).powi(3), sin, cos - 1.0, 1.0]
                })
                .map(|[a, b, s, c, o]| curve([a, b, s, c, wave_number], o))
        };
        let range = TURNS.map(|turns| turns * TAU / columns.span);
        let wave_number = lowest(range, |n| {
            rippled(n).map_or(f64::INFINITY, |values| columns.left(&KIND, &values))
        });
        bent.into_iter().chain(rippled(wave_number)).collect()
    }

    fn count_in_columns(&self, values: &[f64]) -> usize {
        if RIPPLE.iter().all(|&place| values[place] == 0.0) {
            // Square, cube and offset.
            return 3;
        }
        values.iter().filter(|value| **value != 0.0).count()
    }

    fn axis(&self) -> Axis {
        Axis::Position
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
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
        let square = move |c: &[f64]| {
            let values = [(0, STEP * c[0] / half), (CUBIC, 0.0), (MIDDLE, middle)];
            with_defaults(&KIND, &values)
        };
        let cube = move |c: &[f64]| {
            let cubic = STEP * c[0] / (half * half);
            with_defaults(&KIND, &[(0, 0.0), (CUBIC, cubic), (MIDDLE, middle)])
        };
        let mut forms = vec![
            Form::new(vec![bent(2)], square),
            Form::new(vec![bent(3)], cube),
        ];
        for &n in &target.waves.of_reading {
            let wave = |shift: f64| {
                misread(path, |x| {
                    let (sin, cos) = (n * x + shift).sin_cos();
                    // The steepest slope of the ripple is that of a gain of this size.
                    [STEP * sin / n, STEP * cos, -STEP * n * sin]
                })
            };
            let columns = vec![wave(0.0), wave(FRAC_PI_2)];
            let form = Form::new(columns, move |c| {
                let [sine, cosine] = [c[0], c[1]].map(|c| STEP * c / n);
                let values = [(0, 0.0), (RIPPLE[0], sine), (RIPPLE[1], cosine), (4, n)];
                with_defaults(&KIND, &values)
            });
            forms.push(form.searched(1));
        }
        forms
    }

    fn noun(&self) -> &'static str {
        "a bent sensor curve"
    }

    fn tell_apart(&self) -> &'static str {
        "The reading is wrong by an amount that depends on position alone, in both directions. A spring or cogging depends on position too, but as a torque. A second sensor of the same position decides."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a bent sensor curve"
    }
}

/// A ripple from the amplitudes of its sine and its cosine. Only a torque that depends on the position can show what
/// the sensor reads at zero.
fn ripple(e: &Evidence<'_>, [sine, cosine]: [f64; 2], scale: f64, waves: Coordinate) -> Term {
    let m = &e.device.mechanics;
    let mut free = vec![linear(2, sine, scale), linear(3, cosine, scale), waves];
    if m.is_pulled() {
        free.push(linear(5, 0.0, scale));
    }
    term(&KIND, free, &[(0, 0.0), (1, 0.0)])
}

/// The ripples that explain most of the missing torque: where the reading is x + g(x), its acceleration is g'(x) ẍ + g''(x) ẋ²
/// more than that of the position.
fn ripples(e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let moments: Vec<Moment> = moments(e).collect();
    let stride = (moments.len() / MOST_MOMENTS).max(1);
    let some: Vec<&Moment> = moments.iter().step_by(stride).collect();
    let positions: Vec<f64> = some.iter().map(|m| m.position).collect();
    let turn = TAU / s.span();
    let highest = s.finest_wave_number().min(MOST_TURNS * turn);
    let apart = TURNS_APART * turn;
    let count = (highest / apart) as usize;
    let mut waves = Waves::of(&positions, apart, apart);
    let tried: Vec<(f64, [f64; 3])> = (1..=count)
        .map(|k| {
            let n = apart * k as f64;
            let waved = some.iter().copied().zip(waves.current());
            let (explained, [sine, cosine]) = explained(waved, n, e.device.mechanics.inertia);
            waves.advance();
            (explained, [n, sine, cosine])
        })
        .collect();
    let mut peaks: Vec<(f64, [f64; 3])> = tried
        .windows(3)
        .filter(|near| near[1].0 > near[0].0.max(near[2].0))
        .map(|near| near[1])
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let peaks = peaks.into_iter().take(PEAKS);
    peaks
        .map(|(_, [n, sine, cosine])| {
            let amplitude = sine.hypot(cosine);
            let most = MOST_SLOPE / n;
            let part = (most / amplitude).min(1.0);
            let scale = (part * amplitude).max(0.1 * most);
            let waves = linear(4, n, apart);
            ripple(e, [part * sine, part * cosine], scale, waves)
        })
        .collect()
}

/// How much of the missing torque, squared, a sine and a cosine in the reading explain, and their amplitudes.
fn explained<'a>(
    moments: impl Iterator<Item = (&'a Moment, &'a [f64; 2])>,
    wave_number: f64,
    inertia: f64,
) -> (f64, [f64; 2]) {
    let mut normal = Matrix2::zeros();
    let mut right = Vector2::zeros();
    for (m, [sin, cos]) in moments {
        let bend = wave_number * m.acceleration;
        let turn = (wave_number * m.velocity).powi(2);
        let row = inertia * Vector2::new(bend * cos - turn * sin, -bend * sin - turn * cos);
        normal += row * row.transpose();
        right += row * m.missing_nm;
    }
    let Some(solution) = normal.cholesky().map(|c| c.solve(&right)) else {
        return (0.0, [0.0; 2]);
    };
    (solution.dot(&right), [solution[0], solution[1]])
}
