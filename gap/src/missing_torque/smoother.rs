//! A Kalman smoother with an unknown torque as third state.
//!
//! The state is (x, v, d) with `J dv/dt = f(t) − k x − b v + d`, where d is a random walk. The unit of time is the median period T, and d
//! is scaled by T²/J, so that all states have the unit of position. The forward pass is a Kalman filter. The backward pass is the
//! modified Bryson-Frazier recursion (Bierman, "Fixed interval smoothing with discrete measurements", 1973). It needs no matrix
//! inversion, and further signals can pass through the same gains with few multiplications per row.

use super::samples::Samples;
use core::ops::Range;
use host_sim::plant::Mechanics;

/// Factor on the intensity of d where friction may stick, because the missing torque there may have any value up to the friction level.
const STICK_INTENSITY: f64 = 100.0;
/// Number of first rows of a stretch that do not count in the likelihood, because the filter has not converged.
const SETTLING_ROWS: usize = 5;
/// Least variance of the noise over the stated one. A coarse encoder at standstill has no noise.
const LEAST_SCALE: f64 = 0.1;

/// The state transition from a row to the next. The fields `xx`, `xv`, `vx` and `vv` are the entries of the transition matrix for x and
/// v.
#[derive(Clone, Copy, Debug)]
struct Transition {
    xx: f64,
    xv: f64,
    vx: f64,
    vv: f64,
    /// Change of x and v by a unit acceleration.
    by_acceleration: [f64; 2],
    /// Covariance by a unit intensity of d: entries xx, xv, xd, vv, vd, dd.
    covariance: [f64; 6],
}

impl Transition {
    /// The transition over a time `t`. Stiffness and viscous friction are divided by the inertia. All are in units of the period.
    fn of(t: f64, stiffness: f64, viscous: f64) -> Self {
        let (phi, push) = exponential(t, stiffness, viscous);
        // Gauss-Legendre quadrature, exact for a free inertia.
        let nodes = [0.5 - 0.15f64.sqrt(), 0.5, 0.5 + 0.15f64.sqrt()];
        let weights = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
        let mut covariance = [0.0; 6];
        for (node, weight) in nodes.iter().zip(weights) {
            let [x, v] = exponential(node * t, stiffness, viscous).1;
            let pairs = [x * x, x * v, x, v * v, v, 1.0];
            for (sum, pair) in covariance.iter_mut().zip(pairs) {
                *sum += weight * t * pair;
            }
        }
        Self {
            xx: phi[0],
            xv: phi[1],
            vx: phi[2],
            vv: phi[3],
            by_acceleration: push,
            covariance,
        }
    }
}

/// `exp(A t)` of `A = [0 1; −k −b]`, and its integral over a unit acceleration.
fn exponential(t: f64, stiffness: f64, viscous: f64) -> ([f64; 4], [f64; 2]) {
    if stiffness == 0.0 {
        let z = viscous * t;
        if z.abs() < 1e-4 {
            let v = t * (1.0 - 0.5 * z + z * z / 6.0);
            let x = t * t * (0.5 - z / 6.0 + z * z / 24.0);
            return ([1.0, v, 0.0, 1.0 - viscous * v], [x, v]);
        }
        let decay = (-z).exp();
        let v = (1.0 - decay) / viscous;
        return ([1.0, v, 0.0, decay], [(t - v) / viscous, v]);
    }
    // Half the trace, and the square of half the difference of the eigenvalues.
    let mean = -0.5 * viscous;
    let split = mean * mean - stiffness;
    let root = split.abs().sqrt();
    let (cosine, sine) = if root * t < 1e-6 {
        ((mean * t).exp(), t * (mean * t).exp())
    } else if split < 0.0 {
        let decay = (mean * t).exp();
        (decay * (root * t).cos(), decay * (root * t).sin() / root)
    } else {
        let [a, b] = [((mean + root) * t).exp(), ((mean - root) * t).exp()];
        (0.5 * (a + b), 0.5 * (a - b) / root)
    };
    let xx = cosine - mean * sine;
    let phi = [xx, sine, -stiffness * sine, cosine + mean * sine];
    // A constant unit acceleration finally deflects the spring by 1/k.
    (phi, [(1.0 - xx) / stiffness, sine])
}

/// The unknown parameters of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Corner frequency of the smoother, rad per period: where torque and noise contribute equally to the position.
    pub corner: f64,
    /// Standard deviation of the clock jitter, in periods.
    pub jitter: f64,
    /// Variance of a reading over the stated one.
    pub scale: f64,
}

/// The state transitions of a recording for one inertia, stiffness and viscous friction.
#[derive(Clone, Debug)]
pub(crate) struct Steps<'a> {
    samples: &'a Samples,
    transitions: Vec<Transition>,
    /// Index in `transitions` of the step of each row.
    of_row: Vec<u32>,
    /// Acceleration per torque, in position units per period² and torque unit.
    per_torque: f64,
    /// Mean variance of a reading, in position units².
    noise_variance: f64,
    /// Rms velocity, in position units per period.
    speed: f64,
}

/// Filter quantities of a row: Kalman gain, inverse variance of the innovation, and predicted covariance.
#[derive(Clone, Copy, Debug)]
struct Gain {
    gain: [f64; 3],
    per_variance: f64,
    /// Entries xx, xv, xd, vv, vd, dd.
    predicted: [f64; 6],
}

/// The gains of the smoother along a recording.
#[derive(Clone, Debug)]
pub(crate) struct Smoother<'a> {
    steps: &'a Steps<'a>,
    gains: Vec<Gain>,
}

/// A smoothed recording, with one value per row.
#[derive(Clone, Debug)]
pub(crate) struct Smoothed {
    /// Position, in position units.
    pub position: Vec<f64>,
    /// Velocity, in position units per s.
    pub velocity: Vec<f64>,
    /// Standard deviation of the velocity, in position units per s.
    pub velocity_std: Vec<f64>,
    /// Missing torque.
    pub torque: Vec<f64>,
    /// Standard deviation of the missing torque.
    pub torque_std: Vec<f64>,
    /// Innovations, in their standard deviations.
    pub innovation: Vec<f64>,
}

impl<'a> Steps<'a> {
    pub fn of(samples: &'a Samples, mechanics: &Mechanics) -> Self {
        let period_s = samples.period_s;
        let viscous = mechanics.viscous / mechanics.inertia * period_s;
        let stiffness = mechanics.stiffness / mechanics.inertia * period_s * period_s;
        let mut transitions: Vec<Transition> = Vec::new();
        let mut last = f64::INFINITY;
        let of_row = samples.step_s.iter().map(|&step_s| {
            let t = step_s / period_s;
            if last.is_infinite() || (t - last).abs() > 1e-6 * last {
                transitions.push(Transition::of(t, stiffness, viscous));
                last = t;
            }
            (transitions.len() - 1) as u32
        });
        let of_row = of_row.collect();
        let n = samples.len().max(1) as f64;
        let squares = samples.stretches.iter().flat_map(|stretch| {
            let x = &samples.position[stretch.rows.clone()];
            let t = &samples.time_s[stretch.rows.clone()];
            // Differences over several rows, so that noise does not count as velocity.
            let lag = 8.min(x.len().saturating_sub(1)).max(1);
            let pairs = (lag..x.len())
                .map(move |i| ((x[i] - x[i - lag]) / (t[i] - t[i - lag]) * period_s).powi(2));
            pairs.collect::<Vec<_>>()
        });
        let speed = (squares.sum::<f64>() / n).sqrt();
        Self {
            transitions,
            of_row,
            per_torque: period_s * period_s / mechanics.inertia,
            noise_variance: samples.noise.iter().map(|s| s * s).sum::<f64>() / n,
            speed,
            samples,
        }
    }

    /// Intensity of d at a corner frequency, in position units² per period⁵.
    fn intensity(&self, noise: &Noise) -> f64 {
        let jitter = (noise.jitter * self.speed).powi(2);
        (self.noise_variance + jitter) * noise.corner.powi(6)
    }

    /// Variance of the reading of a row at `velocity`, in position units per s.
    #[inline]
    fn reading_variance(&self, row: usize, noise: &Noise, velocity: f64) -> f64 {
        let moved = velocity * self.samples.period_s * noise.jitter;
        self.samples.noise[row].powi(2) + moved * moved
    }

    /// Covariance before the first reading of a stretch. The position comes from the reading; velocity and torque are nearly unknown.
    fn first(&self, row: usize, noise: &Noise) -> [f64; 6] {
        let acceleration = self.speed * self.speed + self.noise_variance;
        [
            100.0 * (self.reading_variance(row, noise, 0.0)) + 1e-3 * acceleration,
            0.0,
            0.0,
            10.0 * acceleration,
            0.0,
            acceleration,
        ]
    }

    /// Profile log-likelihood of the rows `within` at a corner frequency and a jitter, and the scale of all variances that maximizes it.
    pub fn likelihood(
        &self,
        within: &[Range<usize>],
        force: &[f64],
        velocity: &[f64],
        sliding: &[bool],
        noise: Noise,
    ) -> (f64, f64) {
        let (mut logs, mut squares, mut count) = (0.0, 0.0, 0.0);
        let intensity = self.intensity(&noise);
        for rows in within {
            let mut p = self.first(rows.start, &noise);
            let mut m = [self.samples.position[rows.start], 0.0, 0.0];
            m[1] = self.first_speed(rows);
            for row in rows.clone() {
                let s = p[0] + self.reading_variance(row, &noise, velocity[row]);
                let e = self.samples.position[row] - m[0];
                if row >= rows.start + SETTLING_ROWS && sliding[row] {
                    logs += s.ln();
                    squares += e * e / s;
                    count += 1.0;
                }
                let gain = [p[0] / s, p[1] / s, p[2] / s];
                for (m, k) in m.iter_mut().zip(gain) {
                    *m += k * e;
                }
                let q = if sliding[row] { 1.0 } else { STICK_INTENSITY };
                let transition = &self.transitions[self.of_row[row] as usize];
                p = predicted_covariance(&updated_covariance(&p, &gain), transition, q * intensity);
                m = predicted_state(&m, transition, self.per_torque * force[row]);
            }
        }
        if count == 0.0 {
            return (f64::NEG_INFINITY, 1.0);
        }
        let scale = (squares / count).max(LEAST_SCALE);
        let likelihood = -0.5 * (logs + count * scale.ln() + squares / scale);
        (likelihood, scale)
    }

    /// Velocity of the first rows, in position units per period.
    fn first_speed(&self, rows: &Range<usize>) -> f64 {
        let last = (rows.start + 8).min(rows.end - 1);
        let passed =
            (self.samples.time_s[last] - self.samples.time_s[rows.start]) / self.samples.period_s;
        if passed > 0.0 {
            (self.samples.position[last] - self.samples.position[rows.start]) / passed
        } else {
            0.0
        }
    }

    /// The gains for a noise, along a motion with `velocity` and with known direction of sliding where `sliding` is true.
    pub fn smoother(&'a self, noise: Noise, velocity: &[f64], sliding: &[bool]) -> Smoother<'a> {
        let intensity = noise.scale * self.intensity(&noise);
        let mut gains = Vec::with_capacity(self.samples.len());
        for stretch in &self.samples.stretches {
            let mut p = self.first(stretch.rows.start, &noise);
            for row in stretch.rows.clone() {
                let variance = noise.scale * self.reading_variance(row, &noise, velocity[row]);
                let s = p[0] + variance;
                let gain = [p[0] / s, p[1] / s, p[2] / s];
                gains.push(Gain {
                    gain,
                    per_variance: 1.0 / s,
                    predicted: p,
                });
                let q = if sliding[row] { 1.0 } else { STICK_INTENSITY };
                let transition = &self.transitions[self.of_row[row] as usize];
                p = predicted_covariance(&updated_covariance(&p, &gain), transition, q * intensity);
            }
        }
        Smoother { steps: self, gains }
    }
}

/// Covariance after a reading.
#[inline]
fn updated_covariance(p: &[f64; 6], k: &[f64; 3]) -> [f64; 6] {
    [
        p[0] - k[0] * p[0],
        p[1] - k[0] * p[1],
        p[2] - k[0] * p[2],
        p[3] - k[1] * p[1],
        p[4] - k[1] * p[2],
        p[5] - k[2] * p[2],
    ]
}

/// Covariance at the next row.
#[inline]
fn predicted_covariance(p: &[f64; 6], t: &Transition, intensity: f64) -> [f64; 6] {
    let [pxx, pxv, pxd, pvv, pvd, pdd] = *p;
    let [gx, gv] = t.by_acceleration;
    // Φ P, rows x and v.
    let [ax, av, ad] = [
        t.xx * pxx + t.xv * pxv + gx * pxd,
        t.xx * pxv + t.xv * pvv + gx * pvd,
        t.xx * pxd + t.xv * pvd + gx * pdd,
    ];
    let [bx, bv, bd] = [
        t.vx * pxx + t.vv * pxv + gv * pxd,
        t.vx * pxv + t.vv * pvv + gv * pvd,
        t.vx * pxd + t.vv * pvd + gv * pdd,
    ];
    let q = &t.covariance;
    [
        ax * t.xx + av * t.xv + ad * gx + intensity * q[0],
        ax * t.vx + av * t.vv + ad * gv + intensity * q[1],
        ad + intensity * q[2],
        bx * t.vx + bv * t.vv + bd * gv + intensity * q[3],
        bd + intensity * q[4],
        pdd + intensity * q[5],
    ]
}

/// State at the next row, with a known acceleration in addition to d.
#[inline]
fn predicted_state(m: &[f64; 3], t: &Transition, acceleration: f64) -> [f64; 3] {
    let push = m[2] + acceleration;
    [
        t.xx * m[0] + t.xv * m[1] + t.by_acceleration[0] * push,
        t.vx * m[0] + t.vv * m[1] + t.by_acceleration[1] * push,
        m[2],
    ]
}

impl Smoother<'_> {
    /// The smoothed motion and the missing torque of the recording under a known `force`.
    pub fn smooth(&self, force: &[f64]) -> Smoothed {
        let n = self.gains.len();
        let samples = self.steps.samples;
        let period_s = samples.period_s;
        let mut smoothed = Smoothed {
            position: vec![0.0; n],
            velocity: vec![0.0; n],
            velocity_std: vec![0.0; n],
            torque: vec![0.0; n],
            torque_std: vec![0.0; n],
            innovation: vec![0.0; n],
        };
        for stretch in &samples.stretches {
            let rows = stretch.rows.clone();
            let mut m = [
                samples.position[rows.start],
                self.steps.first_speed(&rows),
                0.0,
            ];
            let mut means = Vec::with_capacity(rows.len());
            for row in rows.clone() {
                let g = &self.gains[row];
                means.push(m);
                let e = samples.position[row] - m[0];
                smoothed.innovation[row] = e * g.per_variance.sqrt();
                for (m, k) in m.iter_mut().zip(g.gain) {
                    *m += k * e;
                }
                m = predicted_state(
                    &m,
                    self.steps.transition(row),
                    self.steps.per_torque * force[row],
                );
            }
            let mut l = [0.0; 3];
            let mut information = [0.0; 6];
            for row in rows.clone().rev() {
                let g = &self.gains[row];
                if row + 1 < rows.end {
                    let t = self.steps.transition(row);
                    l = propagated_adjoint(&l, t);
                    information = propagated_information(&information, t);
                }
                let e = samples.position[row] - means[row - rows.start][0];
                update_adjoint(&mut l, g, e);
                information = updated_information(&information, g);
                let mean = &means[row - rows.start];
                let p = &g.predicted;
                let at = |k: usize| {
                    let r = row_of(p, k);
                    mean[k] - (r[0] * l[0] + r[1] * l[1] + r[2] * l[2])
                };
                let variance = |k: usize| {
                    let r = row_of(p, k);
                    let own = r[k];
                    let b = product_with(&information, &r);
                    (own - (r[0] * b[0] + r[1] * b[1] + r[2] * b[2])).max(0.0)
                };
                smoothed.position[row] = at(0);
                smoothed.velocity[row] = at(1) / period_s;
                smoothed.velocity_std[row] = variance(1).sqrt() / period_s;
                smoothed.torque[row] = at(2) / self.steps.per_torque;
                smoothed.torque_std[row] = variance(2).sqrt() / self.steps.per_torque;
            }
        }
        smoothed
    }

    /// The response of the smoother to torques in addition to the known ones, one per step and lane, and to sensor errors, one per row
    /// and lane. The result is a torque per row, smoothed like the missing torque.
    pub fn respond<const L: usize>(
        &self,
        torque: &[[f64; L]],
        reading: Option<&[[f64; L]]>,
    ) -> Vec<[f64; L]> {
        let n = self.gains.len();
        let mut out = vec![[0.0; L]; n];
        let mut errors = vec![[0.0; L]; n];
        for stretch in &self.steps.samples.stretches {
            let rows = stretch.rows.clone();
            let mut m = [[0.0; L]; 3];
            if let Some(reading) = reading {
                m[0] = reading[rows.start];
            }
            for row in rows.clone() {
                let g = &self.gains[row];
                let t = self.steps.transition(row);
                for lane in 0..L {
                    let read = reading.map_or(0.0, |reading| reading[row][lane]);
                    let e = read - m[0][lane];
                    errors[row][lane] = e;
                    out[row][lane] = m[2][lane];
                    let x = m[0][lane] + g.gain[0] * e;
                    let v = m[1][lane] + g.gain[1] * e;
                    let d = m[2][lane] + g.gain[2] * e;
                    // The torque acts on the motion and is unknown to the model. The estimated d is the torque that the model would need
                    // instead.
                    let push = d - self.steps.per_torque * torque[row][lane];
                    m[0][lane] = t.xx * x + t.xv * v + t.by_acceleration[0] * push;
                    m[1][lane] = t.vx * x + t.vv * v + t.by_acceleration[1] * push;
                    m[2][lane] = d;
                }
            }
            let mut l = [[0.0; L]; 3];
            for row in rows.clone().rev() {
                let g = &self.gains[row];
                let t = self.steps.transition(row);
                let r = row_of(&g.predicted, 2);
                let inner = row + 1 < rows.end;
                for lane in 0..L {
                    let mut a = [l[0][lane], l[1][lane], l[2][lane]];
                    if inner {
                        a = propagated_adjoint(&a, t);
                    }
                    update_adjoint(&mut a, g, errors[row][lane]);
                    let d = out[row][lane] - (r[0] * a[0] + r[1] * a[1] + r[2] * a[2]);
                    out[row][lane] = d / self.steps.per_torque;
                    for (l, a) in l.iter_mut().zip(a) {
                        l[lane] = a;
                    }
                }
            }
        }
        out
    }
}

impl Steps<'_> {
    #[inline]
    fn transition(&self, row: usize) -> &Transition {
        &self.transitions[self.of_row[row] as usize]
    }
}

/// `Φᵀ l`.
#[inline]
fn propagated_adjoint(l: &[f64; 3], t: &Transition) -> [f64; 3] {
    [
        t.xx * l[0] + t.vx * l[1],
        t.xv * l[0] + t.vv * l[1],
        t.by_acceleration[0] * l[0] + t.by_acceleration[1] * l[1] + l[2],
    ]
}

/// `(1 − K H)ᵀ l − Hᵀ e/s`.
#[inline]
fn update_adjoint(l: &mut [f64; 3], g: &Gain, e: f64) {
    let carried = g.gain[0] * l[0] + g.gain[1] * l[1] + g.gain[2] * l[2];
    l[0] -= carried + e * g.per_variance;
}

/// A row of a symmetric matrix that is stored as xx, xv, xd, vv, vd, dd.
#[inline]
fn row_of(p: &[f64; 6], row: usize) -> [f64; 3] {
    match row {
        0 => [p[0], p[1], p[2]],
        1 => [p[1], p[3], p[4]],
        _ => [p[2], p[4], p[5]],
    }
}

#[inline]
fn product_with(p: &[f64; 6], r: &[f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let row = row_of(p, k);
        row[0] * r[0] + row[1] * r[1] + row[2] * r[2]
    })
}

/// `Φᵀ Λ Φ`.
#[inline]
fn propagated_information(p: &[f64; 6], t: &Transition) -> [f64; 6] {
    let columns = [
        [t.xx, t.vx, 0.0],
        [t.xv, t.vv, 0.0],
        [t.by_acceleration[0], t.by_acceleration[1], 1.0],
    ];
    let products = columns.map(|column| product_with(p, &column));
    let dot = |a: usize, b: usize| {
        let (c, q) = (&columns[a], &products[b]);
        c[0] * q[0] + c[1] * q[1] + c[2] * q[2]
    };
    [
        dot(0, 0),
        dot(0, 1),
        dot(0, 2),
        dot(1, 1),
        dot(1, 2),
        dot(2, 2),
    ]
}

/// `(1 − K H)ᵀ Λ (1 − K H) + Hᵀ H/s`.
#[inline]
fn updated_information(p: &[f64; 6], g: &Gain) -> [f64; 6] {
    let k = &g.gain;
    // Column x of 1 − K H is (1 − k_x, −k_v, −k_d), the others are unit vectors.
    let first = [1.0 - k[0], -k[1], -k[2]];
    let product = product_with(p, &first);
    let xx = first[0] * product[0] + first[1] * product[1] + first[2] * product[2];
    [
        xx + g.per_variance,
        product[1],
        product[2],
        p[3],
        p[4],
        p[5],
    ]
}
