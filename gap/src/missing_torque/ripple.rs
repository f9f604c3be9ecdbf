//! Waves over the position: which wave numbers a missing torque may have.

use super::path::Path;
use super::regression::Rows;
use core::f64::consts::{PI, TAU};

/// Rows in which waves are looked for, and wave numbers that are tried.
const ROWS: usize = 1000;
const NUMBERS: usize = 2000;
/// Wave numbers that are given of each kind.
const STRONGEST: usize = 3;

/// Wave numbers, in rad per unit of position, of waves that explain most.
#[derive(Clone, Debug, Default)]
pub(crate) struct Waves {
    /// Of a torque.
    pub strongest: Vec<f64>,
    /// Of a torque against the motion.
    pub resisting: Vec<f64>,
    /// Of an error of the reading.
    pub of_reading: Vec<f64>,
}

/// What a scan over wave numbers sees.
struct Scan {
    position: Vec<f64>,
    /// Velocity over the corner of the smoother.
    speed: Vec<f64>,
    torque: Vec<f64>,
    weight: Vec<f64>,
}

impl Waves {
    /// Of a torque at the rows of a fit; `corner` is that of the smoother, rad/s.
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
        let [lowest, highest] = numbers(&plain, span);
        let mut resisting = scan(&|i| -path.direction[rows.rows[i]]);
        // The level itself is no wave.
        resisting.centred();
        let mut torque = plain;
        torque.centred();
        let strongest = |peaks: Vec<(f64, f64)>| -> Vec<f64> {
            peaks.into_iter().take(STRONGEST).map(|(n, _)| n).collect()
        };
        let by_speed = |scan: &Scan| {
            // The error of a reading shows as n² v² of it.
            scan.peaks(lowest, highest, span, |n, speed| {
                (n * speed * corner).powi(2)
            })
        };
        let as_is = |scan: &Scan| scan.peaks(lowest, highest, span, |_, _| 1.0);
        Self {
            strongest: strongest(as_is(&torque)),
            resisting: strongest(as_is(&resisting)),
            of_reading: strongest(by_speed(&torque)),
        }
    }
}

/// Lowest and highest wave number: a wave over the span, and what the smoother still follows at half of the usual speed.
fn numbers(scan: &Scan, span: f64) -> [f64; 2] {
    let n = scan.speed.len().max(1) as f64;
    let speed = (scan.speed.iter().map(|s| s * s).sum::<f64>() / n).sqrt();
    let lowest = 0.7 * TAU / span;
    let highest = 2.0 / speed.max(f64::MIN_POSITIVE);
    let apart = 0.4 * PI / span;
    [
        lowest,
        highest.min(lowest + NUMBERS as f64 * apart).max(lowest),
    ]
}

impl Scan {
    fn centred(&mut self) {
        let sum: f64 = self.weight.iter().sum();
        let pairs = self.torque.iter().zip(&self.weight);
        let mean = pairs.map(|(t, w)| t * w).sum::<f64>() / sum.max(f64::MIN_POSITIVE);
        self.torque.iter_mut().for_each(|t| *t -= mean);
    }

    /// Wave numbers at which a wave explains more than at those beside it, with the share that it explains, the most first.
    fn peaks(
        &self,
        lowest: f64,
        highest: f64,
        span: f64,
        size: impl Fn(f64, f64) -> f64,
    ) -> Vec<(f64, f64)> {
        let apart = 0.4 * PI / span;
        let count = ((highest - lowest) / apart) as usize + 1;
        let mut now: Vec<[f64; 2]> = self
            .position
            .iter()
            .map(|x| (lowest * x).sin_cos().into())
            .collect();
        let turns: Vec<[f64; 2]> = self
            .position
            .iter()
            .map(|x| (apart * x).sin_cos().into())
            .collect();
        let tried = (0..count).map(|k| {
            let n = lowest + apart * k as f64;
            let [mut ss, mut sc, mut cc, mut sy, mut cy] = [0.0; 5];
            for i in 0..now.len() {
                let [sin, cos] = now[i];
                let z = (n * self.speed[i]).powi(2);
                let passed = size(n, self.speed[i]) / (1.0 + z * z * z);
                let (s, c) = (passed * sin, passed * cos);
                let (w, y) = (self.weight[i], self.torque[i]);
                ss += w * s * s;
                sc += w * s * c;
                cc += w * c * c;
                sy += w * s * y;
                cy += w * c * y;
                let [turn_sin, turn_cos] = turns[i];
                now[i] = [
                    sin * turn_cos + cos * turn_sin,
                    cos * turn_cos - sin * turn_sin,
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
                // Vertex of the parabola through the three.
                let [a, b, c] = [near[0].1, near[1].1, near[2].1];
                let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
                (near[1].0 + apart * shift.clamp(-0.5, 0.5), b)
            })
            .collect();
        // Less than a wave over the span has no peak.
        peaks.extend(
            tried
                .first()
                .filter(|first| tried.get(1).is_none_or(|next| first.1 > next.1)),
        );
        peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
        peaks
    }
}
