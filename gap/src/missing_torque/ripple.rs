//! Finds wave numbers over the position that a missing torque may have.

use super::path::Path;
use super::regression::Rows;
use core::f64::consts::{PI, TAU};

/// Number of rows for the search, and number of wave numbers that are tried.
const ROWS: usize = 1000;
const NUMBERS: usize = 2000;
/// Number of wave numbers of each kind.
const STRONGEST: usize = 3;

/// Wave numbers of the waves that explain most, rad per position unit.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waves {
    /// Wave numbers of a torque.
    pub strongest: Vec<f64>,
    /// Wave numbers of a friction torque.
    pub resisting: Vec<f64>,
    /// Wave numbers of a sensor error.
    pub of_reading: Vec<f64>,
}

/// The data of a scan over wave numbers.
struct Scan {
    position: Vec<f64>,
    /// Velocity over the corner frequency of the smoother.
    speed: Vec<f64>,
    torque: Vec<f64>,
    weight: Vec<f64>,
}

impl Waves {
    /// Finds wave numbers for a torque at the rows of a fit. `corner` is the corner frequency of the smoother, rad/s.
    pub(super) fn of(path: &Path<'_>, rows: &Rows, torque: &[f64], corner: f64) -> Self {
        let every = rows.rows.len().div_ceil(ROWS).max(1);
        let some: Vec<usize> = (0..rows.rows.len()).step_by(every).collect();
        let of = |f: &dyn Fn(usize) -> f64| some.iter().map(|&i| f(i)).collect::<Vec<f64>>();
        let scan = |factor: &dyn Fn(usize) -> f64| Scan {
            position: of(&|i| path.position[rows.rows[i]]),
            speed: of(&|i| path.velocity[rows.rows[i]] / corner),
            torque: of(&|i| torque[i] * factor(i)),
            weight: of(&|i| rows.weight[i]),
        };
        let plain = scan(&|_| 1.0);
        let span = 2.0 * path.scale.half_span();
        let [lowest, highest] = wave_numbers(&plain, span);
        let mut resisting = scan(&|i| -path.direction[rows.rows[i]]);
        // The mean is subtracted because it is not part of a wave.
        resisting.subtract_mean();
        let mut torque = plain;
        torque.subtract_mean();
        let strongest = |peaks: Vec<(f64, f64)>| -> Vec<f64> {
            peaks.into_iter().take(STRONGEST).map(|(n, _)| n).collect()
        };
        let by_speed = |scan: &Scan| {
            // A sensor error of wave number n at speed v causes an apparent torque proportional to n² v².
            scan.peaks(lowest, highest, span, |n, speed| {
                (n * speed * corner).powi(2)
            })
        };
        let unweighted = |scan: &Scan| scan.peaks(lowest, highest, span, |_, _| 1.0);
        Self {
            strongest: strongest(unweighted(&torque)),
            resisting: strongest(unweighted(&resisting)),
            of_reading: strongest(by_speed(&torque)),
        }
    }
}

/// Lowest and highest wave number: about one period over the range, and the highest that the smoother resolves at half of the rms speed.
fn wave_numbers(scan: &Scan, span: f64) -> [f64; 2] {
    let n = scan.speed.len().max(1) as f64;
    let speed = (scan.speed.iter().map(|s| s * s).sum::<f64>() / n).sqrt();
    let lowest = 0.7 * TAU / span;
    let highest = 2.0 / speed.max(f64::MIN_POSITIVE);
    let step = 0.4 * PI / span;
    [
        lowest,
        highest.min(lowest + NUMBERS as f64 * step).max(lowest),
    ]
}

impl Scan {
    fn subtract_mean(&mut self) {
        let sum: f64 = self.weight.iter().sum();
        let pairs = self.torque.iter().zip(&self.weight);
        let mean = pairs.map(|(t, w)| t * w).sum::<f64>() / sum.max(f64::MIN_POSITIVE);
        self.torque.iter_mut().for_each(|t| *t -= mean);
    }

    /// The local maxima of the squares that a wave explains, largest first, each as a wave number and the explained squares.
    fn peaks(
        &self,
        lowest: f64,
        highest: f64,
        span: f64,
        size: impl Fn(f64, f64) -> f64,
    ) -> Vec<(f64, f64)> {
        let step = 0.4 * PI / span;
        let count = ((highest - lowest) / step) as usize + 1;
        let mut current: Vec<[f64; 2]> = self
            .position
            .iter()
            .map(|x| (lowest * x).sin_cos().into())
            .collect();
        let rotations: Vec<[f64; 2]> = self
            .position
            .iter()
            .map(|x| (step * x).sin_cos().into())
            .collect();
        let tried = (0..count).map(|k| {
            let n = lowest + step * k as f64;
            let [mut ss, mut sc, mut cc, mut sy, mut cy] = [0.0; 5];
            for i in 0..current.len() {
                let [sin, cos] = current[i];
                let z = (n * self.speed[i]).powi(2);
                let passed = size(n, self.speed[i]) / (1.0 + z * z * z);
                let (s, c) = (passed * sin, passed * cos);
                let (w, y) = (self.weight[i], self.torque[i]);
                ss += w * s * s;
                sc += w * s * c;
                cc += w * c * c;
                sy += w * s * y;
                cy += w * c * y;
                let [step_sin, step_cos] = rotations[i];
                current[i] = [
                    sin * step_cos + cos * step_sin,
                    cos * step_cos - sin * step_sin,
                ];
            }
            let determinant = ss * cc - sc * sc;
            if determinant <= 1e-9 * ss * cc {
                return (n, 0.0);
            }
            let explained = (cc * sy * sy - 2.0 * sc * sy * cy + ss * cy * cy) / determinant;
            (n, explained)
        });
        let tried: Vec<(f64, f64)> = tried.collect();
        let mut peaks: Vec<(f64, f64)> = tried
            .windows(3)
            .filter(|near| near[1].1 > near[0].1 && near[1].1 >= near[2].1)
            .map(|near| {
                // Vertex of the parabola through the three points.
                let [a, b, c] = [near[0].1, near[1].1, near[2].1];
                let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
                (near[1].0 + step * shift.clamp(-0.5, 0.5), b)
            })
            .collect();
        // Less than one period over the range has no local maximum.
        peaks.extend(
            tried
                .first()
                .filter(|first| tried.get(1).is_none_or(|next| first.1 > next.1)),
        );
        peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
        peaks
    }
}
