//! The sensing effect that turns one column into the other.

use super::columns::{Columns, Track};
use crate::fit::whitening::dot;
use host_sim::device::Device;
use host_sim::effects::{self, Kind};
use host_sim::sensing::Reading;
use nalgebra::{DMatrix, DVector};
use recording::Model;
use std::f64::consts::TAU;

/// Points of a search along one parameter, over the whole range, and steps that narrow it then.
const GRID: usize = 24;
const NARROWINGS: usize = 24;
/// Ranges that are searched, over the span of the motion, the duration of a window, and in periods of a ripple.
const WIDTHS: [f64; 2] = [1e-4, 0.5];
const LAGS: [f64; 2] = [1e-4, 1.0];
const TURNS: [f64; 2] = [0.25, 4.0];
/// Ways after a turn within which a reading comes to stay behind, over that width; none for play.
const REACHES: [f64; 3] = [0.0, 1.5, 3.0];
/// Over the fastest motion.
const SPEEDS: [f64; 2] = [0.02, 0.98];
/// More jumps than this are no lost counts.
const MOST_JUMPS: usize = 12;
/// A jump must reduce the squares by this, in variances, and be this high, in standard deviations.
const JUMP_GAIN: f64 = 40.0;
const JUMP_HEIGHT: f64 = 3.0;
/// And this share of the highest.
const LEAST_JUMP: f64 = 0.1;
/// Samples between two jumps at least: a column that lags shows the kick of a loop that believed the jump.
const APART: usize = 10;
/// Within this share of what the best one closes, fewer parameters win.
const PARSIMONY: f64 = 0.01;

/// What a sensing effect leaves of the disagreement.
#[derive(Clone, Debug)]
pub(super) struct Likeness {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
    /// Mean square.
    pub left: f64,
    parameters: usize,
}

/// What all sensing effects leave, the likeliest first.
pub(super) fn likenesses(columns: &Columns) -> Vec<Likeness> {
    let scope = Scope::of(columns);
    let kinds = super::SENSING.into_iter().filter_map(effects::kind);
    let mut all: Vec<Likeness> = kinds
        .flat_map(|kind| scope.fits(kind).into_iter().map(move |v| (kind, v)))
        .map(|(kind, values)| scope.likeness(kind, values))
        .collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    let Some(best) = all.first().map(|first| first.left) else {
        return all;
    };
    let close = best + PARSIMONY * (scope.before() - best).max(0.0);
    let likeliest = (0..all.len())
        .filter(|&i| all[i].left <= close)
        .min_by_key(|&i| (all[i].parameters, i));
    if let Some(likeliest) = likeliest {
        let first = all.remove(likeliest);
        all.insert(0, first);
    }
    all
}

/// What `kind` leaves, sample by sample over all tracks, less the mean: the columns' zeros may differ.
pub(super) fn residuals(tracks: &[Track], kind: &Kind, values: &[f64]) -> Vec<f64> {
    let mut device = Device::nominal(&Model::new(1.0));
    kind.install(&mut device, values);
    let sensing = &device.sensing;
    let mut all = Vec::new();
    for track in tracks {
        let mut reading = Reading::at_rest(sensing, track.reference[0]);
        let mut before_s = track.session_s[0];
        for ((&now_s, &x), shown) in track
            .session_s
            .iter()
            .zip(&track.reference)
            .zip(&track.shown)
        {
            let y = reading.follow(sensing, x, now_s - before_s) + sensing.jumped(now_s);
            before_s = now_s;
            all.push(shown - y);
        }
    }
    less_mean(all)
}

/// The disagreement, less its mean.
pub(super) fn disagreement(tracks: &[Track]) -> Vec<f64> {
    less_mean(differences(tracks))
}

fn differences(tracks: &[Track]) -> Vec<f64> {
    let differences = tracks.iter().flat_map(|track| {
        let pairs = track.shown.iter().zip(&track.reference);
        pairs.map(|(shown, x)| shown - x)
    });
    differences.collect()
}

fn less_mean(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|v| *v -= mean);
    values
}

pub(super) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64
}

/// The disagreement with the sizes of things in it.
struct Scope<'a> {
    columns: &'a Columns,
    difference: Vec<f64>,
    reference: Vec<f64>,
    span: f64,
    /// Largest distance from zero.
    reach: f64,
    window_s: f64,
}

impl<'a> Scope<'a> {
    fn of(columns: &'a Columns) -> Self {
        let tracks = &columns.tracks;
        let reference: Vec<f64> = tracks.iter().flat_map(|t| &t.reference).copied().collect();
        let (low, high) = reference
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(*x), high.max(*x))
            });
        let window = tracks.first().and_then(|track| {
            let window = track.windows.first()?;
            Some(track.session_s[window.end - 1] - track.session_s[window.start])
        });
        Self {
            columns,
            difference: differences(tracks),
            span: (high - low).max(f64::MIN_POSITIVE),
            reach: low.abs().max(high.abs()).max(f64::MIN_POSITIVE),
            window_s: window.unwrap_or(0.0).max(f64::MIN_POSITIVE),
            reference,
        }
    }

    fn before(&self) -> f64 {
        mean_square(&less_mean(self.difference.clone()))
    }

    fn left(&self, kind: &Kind, values: &[f64]) -> f64 {
        mean_square(&residuals(&self.columns.tracks, kind, values))
    }

    /// Parameters of `kind` that suit best, one set for each of its forms.
    fn fits(&self, kind: &'static Kind) -> Vec<Vec<f64>> {
        match kind.name {
            "sensor_gain" => self
                .linear(|x| [x, 1.0])
                .map(|[slope, _]| vec![1.0 + slope, 0.0])
                .into_iter()
                .collect(),
            "sensor_nonlinearity" => self.curves(kind),
            "sensor_hysteresis" => {
                let of_reach = |reach: f64| {
                    let range = WIDTHS.map(|f| f * self.span);
                    let values = |width: f64| vec![width, reach * width];
                    values(lowest(range, |width| self.left(kind, &values(width))))
                };
                REACHES.map(of_reach).to_vec()
            }
            "sensor_lag" => {
                let lag = |twice: f64| {
                    let range = LAGS.map(|f| f * self.window_s);
                    vec![lowest(range, |tau| self.left(kind, &[tau, twice])), twice]
                };
                vec![lag(0.0), lag(1.0)]
            }
            _ => self
                .jumps(kind)
                .into_iter()
                .chain(self.overspeed(kind))
                .collect(),
        }
    }

    /// A bent curve, and one with a ripple.
    fn curves(&self, kind: &Kind) -> Vec<Vec<f64>> {
        let r = self.reach;
        let curve =
            |[a, b, s, c, n]: [f64; 5], o| vec![a / (r * r), b / r.powi(3), s, c, n, o, 0.0];
        let bent = self.linear(|x| [(x / r).powi(2), (x / r).powi(3), 1.0]);
        let bent = bent.map(|[a, b, o]| curve([a, b, 0.0, 0.0, 1.0 / r], o));
        let rippled = |wave_number: f64| {
            self.linear(|x| {
                let (sin, cos) = (wave_number * x).sin_cos();
                [(x / r).powi(2), (x / r).powi(3), sin, cos - 1.0, 1.0]
            })
            .map(|[a, b, s, c, o]| curve([a, b, s, c, wave_number], o))
        };
        let range = TURNS.map(|turns| turns * TAU / self.span);
        let wave_number = lowest(range, |n| {
            rippled(n).map_or(f64::INFINITY, |values| self.left(kind, &values))
        });
        bent.into_iter().chain(rippled(wave_number)).collect()
    }

    /// Least squares of the disagreement by functions of the reference.
    fn linear<const N: usize>(&self, row: impl Fn(f64) -> [f64; N]) -> Option<[f64; N]> {
        let mut normal = DMatrix::<f64>::zeros(N, N);
        let mut right = DVector::<f64>::zeros(N);
        for (&x, difference) in self.reference.iter().zip(&self.difference) {
            let row = row(x);
            for a in 0..N {
                right[a] += row[a] * difference;
                for b in 0..N {
                    normal[(a, b)] += row[a] * row[b];
                }
            }
        }
        let solution = normal.cholesky()?.solve(&right);
        let found: [f64; N] = core::array::from_fn(|i| solution[i]);
        found.iter().all(|c| c.is_finite()).then_some(found)
    }

    /// Time and height of each step between stretches on which the disagreement is constant, by binary
    /// segmentation (Scott and Knott, Biometrics 30, 1974).
    fn jumps(&self, kind: &Kind) -> Option<Vec<f64>> {
        let tracks = &self.columns.tracks;
        let times: Vec<f64> = tracks.iter().flat_map(|t| &t.session_s).copied().collect();
        let mut sums = vec![0.0];
        for difference in &self.difference {
            sums.push(sums[sums.len() - 1] + difference);
        }
        let total = |from: usize, to: usize| (sums[to] - sums[from], (to - from) as f64);
        let variance = self.columns.variance;
        // Height and place of the next split, if it is no noise.
        let next = |edges: &[usize]| {
            let splits = edges.windows(2).flat_map(|pair| {
                let (from, to) = (pair[0], pair[1]);
                (from + APART..(to + 1).saturating_sub(APART)).map(move |at| (from, at, to))
            });
            let gains = splits.map(|(from, at, to)| {
                let ((a, n), (b, m)) = (total(from, at), total(at, to));
                let height = b / m - a / n;
                (height * height * n * m / (n + m), height, at)
            });
            let (gain, height, at) = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
            let is_noise =
                gain < JUMP_GAIN * variance || height.powi(2) < JUMP_HEIGHT.powi(2) * variance;
            (!is_noise).then_some((height, at))
        };
        let mut edges = vec![0, times.len()];
        let mut further = next(&edges);
        while let Some((_, at)) = further.filter(|_| edges.len() < MOST_JUMPS + 2) {
            edges.push(at);
            edges.sort_unstable();
            further = next(&edges);
        }
        // Level before each edge and height there.
        let steps = |edges: &[usize]| -> Vec<(usize, f64, f64)> {
            let steps = edges.windows(3).map(|edge| {
                let ((a, n), (b, m)) = (total(edge[0], edge[1]), total(edge[1], edge[2]));
                (edge[1], a / n, b / m - a / n)
            });
            steps.collect()
        };
        let all = steps(&edges);
        let highest = all.iter().fold(0.0f64, |high, step| high.max(step.2.abs()));
        let is_small = |height: f64| height.abs() < LEAST_JUMP * highest;
        if further.is_some_and(|(height, _)| !is_small(height)) {
            return None;
        }
        let small = all.iter().filter(|step| is_small(step.2));
        for (at, ..) in small {
            edges.retain(|edge| edge != at);
        }
        let timed = |(at, level, height): (usize, f64, f64)| {
            // Samples that are means show by their heights when within them it jumped.
            let share = |i: usize| ((self.difference[i] - level) / height).clamp(0.0, 1.0);
            let late = 1.5 - share(at - 1) - share(at);
            [times[at - 1] + late * (times[at] - times[at - 1]), height]
        };
        let steps: Vec<_> = steps(&edges).into_iter().map(timed).collect();
        (!steps.is_empty()).then(|| kind.events(&steps))
    }

    /// What a counter loses that cannot follow fast motion.
    fn overspeed(&self, kind: &Kind) -> Option<Vec<f64>> {
        let fastest = self.columns.tracks.iter().flat_map(Track::rates);
        let fastest = fastest.fold(0.0f64, |fastest, rate| fastest.max(rate.abs()));
        let values = |speed: f64, share: f64| {
            let mut values = kind.events(&[[0.0; 2]]);
            values[2..].copy_from_slice(&[share, speed]);
            values
        };
        let difference = less_mean(self.difference.clone());
        // The share that suits best, as what is lost is in proportion to it, and what it leaves.
        let suited = |speed: f64| {
            let all = residuals(&self.columns.tracks, kind, &values(speed, 1.0));
            let lost: Vec<f64> = all.iter().zip(&difference).map(|(a, d)| a - d).collect();
            let share = -dot(&lost, &difference) / dot(&lost, &lost).max(f64::MIN_POSITIVE);
            let share = share.clamp(0.0, 1.0);
            let left = difference.iter().zip(&lost).map(|(d, l)| d + share * l);
            (share, mean_square(&left.collect::<Vec<_>>()))
        };
        let speed = lowest(SPEEDS.map(|f| f * fastest), |speed| suited(speed).1);
        let (share, _) = suited(speed);
        (share > 0.0).then(|| values(speed, share))
    }

    fn likeness(&self, kind: &'static Kind, values: Vec<f64>) -> Likeness {
        let left = self.left(kind, &values);
        let parameters = match kind.name {
            // Without its ripple.
            "sensor_nonlinearity" if values[2] == 0.0 && values[3] == 0.0 => 3,
            _ => values.iter().filter(|value| **value != 0.0).count(),
        };
        Likeness {
            kind,
            values,
            left,
            parameters,
        }
    }
}

/// Where `f` is lowest in a range of positive values: on a logarithmic grid, then by golden sections around its
/// lowest point (Kiefer, Proceedings of the AMS 4, 1953).
fn lowest(range: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let [low, high] = range.map(f64::ln);
    let at = |k: usize| low + (high - low) * k as f64 / (GRID - 1) as f64;
    let values: Vec<f64> = (0..GRID).map(|k| f(at(k).exp())).collect();
    let best = (0..GRID).min_by(|&a, &b| values[a].total_cmp(&values[b]));
    let best = best.unwrap_or(0);
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(GRID - 1)));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut fc, mut fd) = (f(c.exp()), f(d.exp()));
    for _ in 0..NARROWINGS {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - golden * (b - a);
            fc = f(c.exp());
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + golden * (b - a);
            fd = f(d.exp());
        }
    }
    (0.5 * (a + b)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is likeliest where a column shows so much more than a slow sine, as a function of time over its duration.
    fn likeliest(more: impl Fn(f64) -> f64) -> &'static str {
        const SAMPLES: usize = 1000;
        const STD: f64 = 1e-3;
        let session_s: Vec<f64> = (0..SAMPLES).map(|i| i as f64 / SAMPLES as f64).collect();
        let reference: Vec<f64> = session_s.iter().map(|t| (TAU * t).sin()).collect();
        let both = session_s.iter().zip(&reference);
        let track = Track {
            shown: both.map(|(t, x)| x + more(*t)).collect(),
            session_s,
            reference,
            windows: std::iter::once(0..SAMPLES).collect(),
        };
        let columns = Columns {
            tracks: vec![track],
            variance: STD * STD,
        };
        likenesses(&columns)[0].kind.name
    }

    #[test]
    fn what_takes_ever_more_jumps_is_none() {
        let jump = |t: f64| if t < 0.3 { 0.0 } else { 0.5 };
        assert_eq!(likeliest(jump), "lost_counts");
        // A gain and a lag.
        let late = |t: f64| -0.4 * (TAU * t).sin() - 0.4 * (TAU * t).cos();
        assert_ne!(likeliest(late), "lost_counts");
    }
}
