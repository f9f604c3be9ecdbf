//! A transmission that is not rigid: two masses, and play or a spring between them.

use super::Evidence;
use super::start::{count, geometric, linear, log, term};
use crate::fit::hypothesis::Term;
use crate::windows::series::FINE_PERIOD_S;
use core::f64::consts::TAU;
use host_sim::effects::Kind;

/// How wide a play may be, over the span of the motion, and the ratio of those that are tried; narrower ones where a run
/// moves less than all do together.
const PLAYS: [f64; 2] = [0.0027, 0.15];
const PLAY_RATIO: f64 = 1.78;
/// Natural frequency of the flanks of a play, over the coarse sampling rate: an impact lasts some samples, and harder
/// flanks do nearly the same.
const FLANK_FREQUENCY: f64 = 0.06;
/// Relative damping of the flanks: a rebound has half the speed.
const FLANK_DAMPING: f64 = 0.22;
/// Shares of the inertia and of the friction beyond a play that are tried with each: a side that flies free tells them.
const FREE_SHARES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const FREE_FRICTIONS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

/// Where a twisting transmission may ring, over the frequency of the motion, and how many resonances are tried: what rings
/// is found within some percent of its frequency only.
const RESONANCES: [f64; 2] = [1.0, 100.0];
const RESONANCE_STARTS: usize = 90;
/// And the highest frequency that samples follow, over their rate.
const HIGHEST_RESONANCE: f64 = 0.2;
/// Its relative damping.
const TWIST_DAMPING: f64 = 0.05;
/// The side on which most of the friction is decides how it rings while one side sticks: shares beyond the twist.
const TWIST_FRICTIONS: [f64; 2] = [0.2, 0.8];
/// Where nothing is known of them.
const HALF: f64 = 0.5;

pub(super) fn plays(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let inertia = e.device.mechanics.inertia;
    let rate = TAU * FLANK_FREQUENCY / e.scales.period_s.max(FINE_PERIOD_S);
    let rubs = rubs(e);
    let frictions = if rubs { &FREE_FRICTIONS[..] } else { &[HALF] };
    let narrower = (e.scales.span() / e.scales.least_span)
        .log(PLAY_RATIO)
        .floor();
    let least = PLAYS[0] * PLAY_RATIO.powf(-narrower);
    let sizes = [least, PLAYS[1]].map(|play| play * e.scales.span());
    two_masses(sizes, count(sizes, PLAY_RATIO), |play| {
        let pairs = FREE_SHARES
            .iter()
            .flat_map(|&share| frictions.iter().map(move |&friction| (share, friction)));
        let start = |(share, friction): (f64, f64)| {
            let reduced = inertia * share * (1.0 - share);
            let mut free = vec![
                log(0, play),
                linear(1, share, 0.15),
                log(2, rate * rate * reduced),
                log(3, 2.0 * FLANK_DAMPING * rate * reduced),
            ];
            free.extend(rubs.then(|| linear(4, friction, 0.3)));
            term(kind, free, &[])
        };
        pairs.map(start).collect()
    })
}

pub(super) fn springs(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let inertia = e.device.mechanics.inertia;
    let rubs = rubs(e);
    let frictions = if rubs { &TWIST_FRICTIONS[..] } else { &[HALF] };
    let highest = HIGHEST_RESONANCE / s.period_s.max(FINE_PERIOD_S);
    let [low, high] = RESONANCES.map(|ratio| (ratio * s.motion_hz()).min(highest));
    two_masses([low, high], RESONANCE_STARTS, |hertz| {
        let stiffness = (TAU * hertz).powi(2) * inertia * HALF * (1.0 - HALF);
        let damping = 2.0 * TWIST_DAMPING * (stiffness * inertia).sqrt();
        let start = |&friction: &f64| {
            let mut free = vec![log(0, stiffness), log(1, damping), linear(2, HALF, 0.15)];
            free.extend(rubs.then(|| linear(3, friction, 0.3)));
            term(kind, free, &[])
        };
        frictions.iter().map(start).collect()
    })
}

/// True if there is friction to share.
fn rubs(e: &Evidence<'_>) -> bool {
    let m = &e.device.mechanics;
    m.friction.highest_nm() > 0.0 || m.viscous > 0.0
}

/// Starts of a transmission between two masses, by the size of what is free in it: `count` values by equal ratios, each
/// for a sensor on the motor's and on the load's side.
fn two_masses(sizes: [f64; 2], count: usize, starts: impl Fn(f64) -> Vec<Term>) -> Vec<Term> {
    let motor: Vec<Term> = geometric(sizes, count).flat_map(starts).collect();
    let load = motor.iter().cloned().map(|start| Term {
        sensor_on_load: true,
        ..start
    });
    let load: Vec<Term> = load.collect();
    [motor, load].concat()
}
