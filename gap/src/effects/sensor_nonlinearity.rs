//! A nonlinear sensor characteristic: a curve over the position, or a ripple.

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

/// Quadratic and cubic deviation of a curve at the ends of the motion, over half of its range.
const CURVES: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [0.2, 0.0],
    [-0.2, 0.0],
    [0.0, 0.3],
    [0.0, -0.15],
];
/// Indices of the cubic coefficient, of the amplitudes of the ripple, and of the position around which the curve is defined.
const CUBIC: usize = 1;
const RIPPLE: [usize; 2] = [2, 3];
const MIDDLE: usize = 6;
/// Numbers of periods of a ripple over the range of the motion that are tried.
const RIPPLES: [f64; 3] = [0.5, 1.0, 2.0];
/// Spacing and largest number of periods over the range of the motion in the search of ripples.
const PERIODS_SPACING: f64 = 0.25;
const MOST_PERIODS: f64 = 150.0;
/// Number of instants for the search of ripples, number of wave numbers for starts, and largest slope of a ripple at the start.
const MOST_MOMENTS: usize = 1500;
const PEAKS: usize = 2;
const MOST_SLOPE: f64 = 0.5;
/// Range of the number of periods of a ripple between two columns, over the range of the motion.
const PERIODS: [f64; 2] = [0.25, 4.0];

#[derive(Debug)]
pub(super) struct SensorNonlinearity;

impl Identification for SensorNonlinearity {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Starts with curves, and with ripples from an eccentric disk or from poles, with one period or a few over the motion.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let reach = s.position[0].abs().max(s.position[1].abs());
        let middle = s.middle();
        // A curve without error at zero, or in the middle of the motion.
        let curved = |middle: f64, reach: f64, [square, cube]: [f64; 2]| {
            let free = vec![
                linear(0, square / reach, 0.2 / reach),
                linear(1, cube / (reach * reach), 0.2 / (reach * reach)),
            ];
            term(&KIND, free, &[(MIDDLE, middle)])
        };
        let rippled = |periods: f64| {
            let wave_number = periods * TAU / s.span();
            let amplitude = 0.1 / wave_number;
            let waves = linear(4, wave_number, 0.2 * wave_number);
            ripple(e, [0.0, amplitude], amplitude, waves)
        };
        let mut all = vec![curved(0.0, reach, [0.0, 0.0])];
        all.extend(CURVES.map(|curvature| curved(middle, 0.5 * s.span(), curvature)));
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

    /// A curve, and a curve with a ripple.
    fn column_fits(&self, columns: &Disagreement<'_>) -> Vec<Vec<f64>> {
        let r = columns.reach;
        let curve =
            |[a, b, s, c, n]: [f64; 5], o| vec![a / (r * r), b / r.powi(3), s, c, n, o, 0.0];
        let curved = columns.linear(|x| [(x / r).powi(2), (x / r).powi(3), 1.0]);
        let curved = curved.map(|[a, b, o]| curve([a, b, 0.0, 0.0, 1.0 / r], o));
        let rippled = |wave_number: f64| {
            columns
                .linear(|x| {
                    let (sin, cos) = (wave_number * x).sin_cos();
                    [(x / r).powi(2), (x / r).powi(3), sin, cos - 1.0, 1.0]
                })
                .map(|[a, b, s, c, o]| curve([a, b, s, c, wave_number], o))
        };
        let range = PERIODS.map(|periods| periods * TAU / columns.span);
        let wave_number = lowest(range, |n| {
            rippled(n).map_or(f64::INFINITY, |values| columns.left(&KIND, &values))
        });
        curved.into_iter().chain(rippled(wave_number)).collect()
    }

    fn count_in_columns(&self, values: &[f64]) -> usize {
        if RIPPLE.iter().all(|&place| values[place] == 0.0) {
            // Quadratic coefficient, cubic coefficient and offset.
            return 3;
        }
        values.iter().filter(|value| **value != 0.0).count()
    }

    fn axis(&self) -> Axis {
        Axis::Position
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let (half, middle) = (path.scale.half_span(), path.scale.middle());
        let curved = |power: i32| {
            misread(path, |x| {
                let z = (x - middle) / half;
                let n = f64::from(power);
                let curvature = n * (n - 1.0) * z.powi(power - 2) / half;
                [
                    STEP * half * z.powi(power),
                    STEP * n * z.powi(power - 1),
                    STEP * curvature,
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
            Form::new(vec![curved(2)], square),
            Form::new(vec![curved(3)], cube),
        ];
        for &n in &target.waves.of_reading {
            let wave = |shift: f64| {
                misread(path, |x| {
                    let (sin, cos) = (n * x + shift).sin_cos();
                    // The largest slope of the ripple per unit of coefficient is [`STEP`].
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

/// A start of a ripple with the amplitudes of its sine and cosine. The offset of the sensor at zero is observable only if a torque
/// depends on the position.
fn ripple(e: &Evidence<'_>, [sine, cosine]: [f64; 2], scale: f64, waves: Coordinate) -> Term {
    let m = &e.device.mechanics;
    let mut free = vec![linear(2, sine, scale), linear(3, cosine, scale), waves];
    if m.is_pulled() {
        free.push(linear(5, 0.0, scale));
    }
    term(&KIND, free, &[(0, 0.0), (1, 0.0)])
}

/// Starts of the ripples that explain most of the missing torque. For a reading x + g(x), the acceleration of the reading exceeds that of
/// the position by g'(x) ẍ + g''(x) ẋ².
fn ripples(e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let moments: Vec<Moment> = moments(e).collect();
    let stride = (moments.len() / MOST_MOMENTS).max(1);
    let some: Vec<&Moment> = moments.iter().step_by(stride).collect();
    let positions: Vec<f64> = some.iter().map(|m| m.position).collect();
    let turn = TAU / s.span();
    let highest = s.finest_wave_number().min(MOST_PERIODS * turn);
    let spacing = PERIODS_SPACING * turn;
    let count = (highest / spacing) as usize;
    let mut waves = Waves::of(&positions, spacing, spacing);
    let tried: Vec<(f64, [f64; 3])> = (1..=count)
        .map(|k| {
            let n = spacing * k as f64;
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
            let waves = linear(4, n, spacing);
            ripple(e, [part * sine, part * cosine], scale, waves)
        })
        .collect()
}

/// Sum of squares of the missing torque that a sine and a cosine in the reading explain, and their amplitudes.
fn explained<'a>(
    moments: impl Iterator<Item = (&'a Moment, &'a [f64; 2])>,
    wave_number: f64,
    inertia: f64,
) -> (f64, [f64; 2]) {
    let mut normal = Matrix2::zeros();
    let mut right = Vector2::zeros();
    for (m, [sin, cos]) in moments {
        let curvature = wave_number * m.acceleration;
        let turn = (wave_number * m.velocity).powi(2);
        let row =
            inertia * Vector2::new(curvature * cos - turn * sin, -curvature * sin - turn * cos);
        normal += row * row.transpose();
        right += row * m.missing_nm;
    }
    let Some(solution) = normal.cholesky().map(|c| c.solve(&right)) else {
        return (0.0, [0.0; 2]);
    };
    (solution.dot(&right), [solution[0], solution[1]])
}
