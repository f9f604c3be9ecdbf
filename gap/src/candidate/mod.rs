//! Where the fit of each effect starts, and in which coordinates.

mod cogging;
mod contact;
mod jumps;
mod regression;

pub(crate) use contact::{one_sided, untouched};

use crate::hypothesis::{Coordinate, Scale, Term};
use crate::motion::{Motion, Scales, quantile};
use crate::series::{FINE_PERIOD_S, Series};
use core::f64::consts::TAU;
use host_sim::device::Device;
use host_sim::effects::{KINDS, Kind};
use regression::{Moment, regress};

/// What starting values are made from.
pub(crate) struct Evidence<'a> {
    pub series: &'a [Series],
    pub motions: &'a [Motion],
    pub scales: &'a Scales,
    /// The device without the effect that is looked for.
    pub device: &'a Device,
    /// Places of the nominal model's stops.
    pub travel: Option<[f64; 2]>,
    /// Robust cost of each window without the effect, by running index.
    pub window_costs: &'a [f64],
}

/// One effect with the points from which it is fitted.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub kind: &'static Kind,
    pub starts: Vec<Term>,
    /// More starts, between which no slope leads: worth a fit where they are near as they are.
    pub grid: Vec<Term>,
}

/// Every effect that the recording could show, in the order of the vocabulary.
pub(crate) fn candidates(evidence: &Evidence<'_>) -> Vec<Candidate> {
    let all = KINDS.iter().map(|&kind| Candidate {
        kind,
        starts: starts(kind, evidence),
        grid: grid(kind, evidence),
    });
    all.filter(|candidate| !candidate.starts.is_empty())
        .collect()
}

const fn linear(parameter: usize, start: f64, scale: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Linear(scale),
    }
}

const fn log(parameter: usize, start: f64) -> Coordinate {
    Coordinate {
        parameter,
        start,
        scale: Scale::Log,
    }
}

/// A term whose free coordinates are all its parameters but those given as fixed.
fn term(kind: &'static Kind, free: Vec<Coordinate>, fixed: &[(usize, f64)]) -> Term {
    let mut values: Vec<f64> = kind.parameters.iter().map(|p| p.default).collect();
    for coordinate in &free {
        values[coordinate.parameter] = coordinate.start;
    }
    for &(parameter, value) in fixed {
        values[parameter] = value;
    }
    Term {
        kind,
        values,
        free,
        sensor_on_load: false,
    }
}

/// Widths of a gate over the input's root mean square, and how many of them.
const GATES: [f64; 2] = [0.03, 1.5];
const GATE_STARTS: usize = 40;

/// Relative damping of the springs that stand in for contacts whose damping is not looked for.
const CONTACT_DAMPING: f64 = 0.1;
/// Natural frequency of bristles, in rad a coarse sample.
const RESOLVED_RATE: f64 = 2.0;
/// Natural frequency of the flanks of a play, over the coarse sampling rate: an impact lasts some samples, and harder
/// flanks do nearly the same.
const FLANK_FREQUENCY: f64 = 0.06;
/// Relative damping of the flanks: a rebound has half the speed.
const FLANK_DAMPING: f64 = 0.22;

/// Shares of the samples that may lie beyond a stop: none where it is touched once.
const STOPPED_SHARES: [f64; 3] = [0.0, 0.005, 0.05];
/// Stiffness of a stop over torque by span of the motion.
const HARDNESS: [f64; 2] = [20.0, 200.0];

/// How suddenly a static friction may fall with speed.
const FALLS: [f64; 2] = [2.0, 1.0];

/// Where a twisting transmission may ring, over the frequency of the motion.
const RESONANCES: [f64; 2] = [1.0, 100.0];
/// And the highest frequency that samples follow, over their rate.
const HIGHEST_RESONANCE: f64 = 0.2;
/// How wide a play may be, over the span of the motion.
const PLAYS: [f64; 2] = [0.0027, 0.15];
/// Resonances that are tried: what rings is found within some percent of its frequency only; and plays.
const RESONANCE_STARTS: usize = 90;
const PLAY_STARTS: usize = 8;
/// Shares of the inertia and of the friction beyond a play that are tried with each: a side that flies free tells them.
const FREE_SHARES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const FREE_FRICTIONS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

/// `count` values by equal ratios.
fn geometric([low, high]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let ratio = (high / low).powf(1.0 / (count - 1) as f64);
    (0..count).map(move |k| low * ratio.powi(k as i32))
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

/// Dead bands that let all through beyond them: each sample comes through at a width of its own.
fn grid(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    if kind.name != "deadband" {
        return Vec::new();
    }
    let widths = geometric(GATES, GATE_STARTS).map(|f| f * e.scales.input);
    widths
        .map(|width| term(kind, vec![log(0, width)], &[(1, 1.0)]))
        .collect()
}

fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let mut all = guesses(kind, e);
    all.extend(spread(kind, e));
    all
}

/// Starts from what the missing torque is made of, for effects that are linear in it.
fn guesses(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let m = &e.device.mechanics;
    let level = m.friction.level_nm;
    let sign = |m: &Moment| m.velocity.signum();
    // A coordinate's scale: that of the thing, or a share of a guess that is larger.
    let scaled =
        |parameter, start: f64, scale: f64| linear(parameter, start, scale.max(0.3 * start.abs()));
    let free = match kind.name {
        "torque_gain" => regress(e, |m| [m.drive_nm]).map(|[g]| vec![log(0, (1.0 + g).max(0.05))]),
        "torque_offset" => regress(e, |_| [1.0]).map(|[t]| vec![scaled(0, t, 0.2 * s.torque)]),
        "coulomb" => regress(e, |m| [-sign(m)])
            .map(|[f]| vec![log(0, (level[0] + f).max(0.05 * s.friction))]),
        "asymmetric_coulomb" => regress(e, |m| {
            let forward = f64::from(m.velocity > 0.0);
            [-forward, 1.0 - forward]
        })
        .map(|[p, n]| {
            let least = 0.05 * s.friction;
            vec![
                log(0, (level[0] + p).max(least)),
                log(1, (level[1] + n).max(least)),
            ]
        }),
        "position_dependent_coulomb" if level[0] > 0.0 => regress(e, |m| {
            let friction = -level[0] * sign(m);
            [
                friction * m.position,
                friction * m.position * m.position,
                friction,
            ]
        })
        .map(|[slope, curve, more]| {
            let reach = s.position[0].abs().max(s.position[1].abs());
            vec![
                scaled(0, slope, 0.3 / reach),
                scaled(1, curve, 0.3 / (reach * reach)),
                log(2, (1.0 + more).max(0.1)),
            ]
        }),
        "viscous" => regress(e, |m| [-m.velocity]).map(|[b]| {
            vec![scaled(
                0,
                (m.viscous + b).max(0.0),
                0.1 * s.torque / s.velocity,
            )]
        }),
        "quadratic_drag" => regress(e, |m| [-m.velocity * m.velocity.abs()])
            .map(|[q]| vec![scaled(0, q.max(0.0), 0.1 * s.torque / s.velocity.powi(2))]),
        "load_dependent_friction" => regress(e, |m| [-m.drive_nm.abs() * sign(m)])
            .map(|[share]| vec![log(0, share.max(0.01))]),
        "friction_drift" if level[0] > 0.0 => regress(e, |m| {
            let friction = -level[0] * sign(m);
            [friction * m.session_s, friction]
        })
        .map(|[rate, more]| {
            vec![
                scaled(0, rate, 0.3 / s.duration_s),
                log(1, (1.0 + more).max(0.1)),
            ]
        }),
        "inertia" => regress(e, |m| [-m.acceleration])
            .map(|[j]| vec![log(0, (m.inertia + j).max(0.1 * m.inertia))]),
        "spring" => regress(e, |m| [-m.position, 1.0]).map(|[k, t]| {
            let stiffness = m.stiffness + k;
            let zero = (t + m.stiffness * m.stiffness_zero) / stiffness;
            let scale = 0.05 * s.torque / s.span();
            vec![scaled(0, stiffness, scale), linear(1, zero, 0.2 * s.span())]
        }),
        "gravity" => regress(e, |m| [-m.position.sin(), m.position.cos()]).map(|[a, b]| {
            let (sin, cos) = m.gravity_zero.sin_cos();
            let (a, b) = (a + m.gravity * cos, b + m.gravity * sin);
            let zero = b.atan2(a);
            vec![scaled(0, a.hypot(b), 0.1 * s.torque), linear(1, zero, 0.1)]
        }),
        _ => None,
    };
    free.map(|free| term(kind, free, &[])).into_iter().collect()
}

/// Periods of a ripple over the span of the motion.
const RIPPLES: [f64; 3] = [0.5, 1.0, 1.8];

/// Starts of a friction that comes and goes with the turns of something that is not round.
fn ripples(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let level = e.device.mechanics.friction.level_nm[0];
    let start = |turns: f64| {
        let wave_number = turns * TAU / e.scales.span();
        let found = regress(e, |m| {
            let friction = -level * m.velocity.signum();
            let (sin, cos) = (wave_number * m.position).sin_cos();
            [friction * sin, friction * (cos - 1.0), friction]
        });
        let [sine, cosine, more] = found?;
        let free = vec![
            log(2, (1.0 + more).max(0.1)),
            linear(3, sine, 0.3),
            linear(4, cosine, 0.3),
            linear(5, wave_number, 0.2 * wave_number),
        ];
        Some(term(kind, free, &[(0, 0.0), (1, 0.0)]))
    };
    RIPPLES.into_iter().filter_map(start).collect()
}

/// Time constants with which a friction settles, over the duration.
const SETTLINGS: [f64; 2] = [0.15, 0.5];

/// Starts of a friction that settles as something warms up.
fn warm_ups(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let level = e.device.mechanics.friction.level_nm[0];
    let start = |share: f64| {
        let settling_s = share * e.scales.duration_s;
        let found = regress(e, |m| {
            let friction = -level * m.velocity.signum();
            [friction * -(-m.session_s / settling_s).exp_m1(), friction]
        });
        let [all, more] = found?;
        let free = vec![
            linear(0, all / settling_s, 0.5 / settling_s),
            log(1, (1.0 + more).max(0.1)),
            log(2, settling_s),
        ];
        Some(term(kind, free, &[]))
    };
    SETTLINGS.into_iter().filter_map(start).collect()
}

/// Square and cube by which a sensor's curve departs at the ends of the motion, over half of its span.
const BENDS: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [0.2, 0.0],
    [-0.2, 0.0],
    [0.0, 0.3],
    [0.0, -0.15],
];

/// Starts spread over the sizes that the recording could show.
fn spread(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let m = &e.device.mechanics;
    let level = m.friction.highest_nm();
    let rubs = level > 0.0 || m.viscous > 0.0;
    let stiffness = s.torque / s.span();
    let one = |free: Vec<Coordinate>| vec![term(kind, free, &[])];
    let each = |starts: &[f64], f: &dyn Fn(f64) -> Vec<Coordinate>| -> Vec<Term> {
        starts
            .iter()
            .map(|&start| term(kind, f(start), &[]))
            .collect()
    };
    let damped = |k: f64, inertia: f64| 2.0 * CONTACT_DAMPING * (k * inertia).sqrt();
    match kind.name {
        "torque_gain" | "sensor_gain" => one(vec![log(0, 1.0)]),
        "torque_offset" => each(&[0.3, -0.3], &|f| {
            vec![linear(0, f * s.friction, 0.2 * s.torque)]
        }),
        "deadband" => each(&[0.05, 0.2, 0.6], &|f| vec![log(0, f * s.input)]),
        "saturation" => {
            let inputs = e.series.iter().flat_map(|s| &s.input);
            let inputs: Vec<f64> = inputs.map(|u| u.abs()).collect();
            // Where it would clip the largest, a few, many.
            let limits = [1.0, 0.99, 0.95, 0.8, 0.5].map(|share| quantile(&inputs, share));
            each(&limits, &|limit| {
                vec![log(0, 0.9 * limit.max(0.1 * s.input))]
            })
        }
        "lag" | "delay" | "sensor_lag" => each(&[1.0, 6.0, 30.0], &|f| {
            vec![log(
                0,
                f * s.period_s.min(0.01 * s.horizon_s).max(0.002 * s.horizon_s),
            )]
        }),
        "cogging" => cogging::starts(kind, e),
        "coulomb" => {
            let mut all = each(&[0.6, 1.4], &|f| vec![log(0, f * s.friction)]);
            // A friction that is not there at all is at the end of a linear scale only.
            all.extend(one(vec![linear(0, 0.02 * s.friction, 0.1 * s.friction)]));
            all
        }
        "asymmetric_coulomb" => [(0.7, 1.3), (1.3, 0.7)]
            .iter()
            .map(|(p, n)| {
                term(
                    kind,
                    vec![log(0, p * s.friction), log(1, n * s.friction)],
                    &[],
                )
            })
            .collect(),
        "position_dependent_coulomb" if level > 0.0 => {
            let reach = s.position[0].abs().max(s.position[1].abs());
            let bends = [(0.4, 0.0), (-0.4, 0.0), (0.0, 0.8)].iter();
            let bent = bends.map(|(slope, curve)| {
                let free = vec![
                    linear(0, slope / reach, 0.5 / reach),
                    linear(1, curve / (reach * reach), 0.5 / (reach * reach)),
                    log(2, 1.0),
                ];
                term(kind, free, &[])
            });
            ripples(kind, e).into_iter().chain(bent).collect()
        }
        "stribeck" if level > 0.0 => [(0.4, 0.03), (0.4, 0.15), (1.0, 0.4)]
            .iter()
            .flat_map(|(rise, v)| {
                let free = vec![linear(0, 1.0 + rise, 0.3), log(1, v * s.velocity)];
                FALLS.map(|exponent| term(kind, free.clone(), &[(2, exponent)]))
            })
            .collect(),
        "viscous" => one(vec![linear(0, m.viscous, 0.1 * s.torque / s.velocity)]),
        "quadratic_drag" => one(vec![linear(0, 0.0, 0.1 * s.torque / s.velocity.powi(2))]),
        "presliding" if level > 0.0 => [0.003, 0.015, 0.06]
            .iter()
            .flat_map(|f| {
                // Bristles that ring faster than samples follow are stick.
                let stiffest = m.inertia * (RESOLVED_RATE / s.period_s.max(FINE_PERIOD_S)).powi(2);
                let distance = (f * s.span()).max(level / stiffest);
                let damping = damped(level / distance, m.inertia) * 3.0;
                let bristles = |last| vec![log(0, distance), log(1, damping), last];
                [
                    term(kind, bristles(log(2, 0.7)), &[]),
                    term(kind, bristles(linear(3, 0.4, 0.2)), &[]),
                ]
            })
            .collect(),
        "load_dependent_friction" => each(&[0.05, 0.2], &|f| vec![log(0, f)]),
        "friction_drift" if level > 0.0 => {
            let mut all = warm_ups(kind, e);
            all.extend(each(&[0.3, -0.3], &|f| {
                vec![linear(0, f / s.duration_s, 0.5 / s.duration_s), log(1, 1.0)]
            }));
            all
        }
        "inertia" => one(vec![log(0, m.inertia)]),
        "gravity" => one(vec![
            linear(0, m.gravity, 0.1 * s.torque),
            linear(1, m.gravity_zero, 0.1 * s.span().min(1.0)),
        ]),
        "spring" => {
            let middle = 0.5 * (s.position[0] + s.position[1]);
            one(vec![
                linear(0, m.stiffness + 0.05 * stiffness, 0.1 * stiffness),
                linear(
                    1,
                    if m.stiffness == 0.0 {
                        middle
                    } else {
                        m.stiffness_zero
                    },
                    0.2 * s.span(),
                ),
            ])
        }
        "end_stop" => {
            let positions: Vec<f64> = e
                .motions
                .iter()
                .flat_map(|m| m.position.iter().copied())
                .collect();
            // One stop at a time, the other out of reach, then both.
            let mut all = contact::as_stops(kind, e);
            for (share, hard) in STOPPED_SHARES
                .iter()
                .flat_map(|&s| HARDNESS.map(|h| (s, h)))
            {
                let (low, high) = (
                    quantile(&positions, share),
                    quantile(&positions, 1.0 - share),
                );
                let far = untouched(e.travel, s.position);
                for (lower, upper) in [(far[0], high), (low, far[1]), (low, high)] {
                    let k = hard * stiffness;
                    let mut free = vec![log(2, k), log(3, damped(k, m.inertia))];
                    if lower > far[0] {
                        free.push(linear(0, lower, 0.05 * s.span()));
                    }
                    if upper < far[1] {
                        free.push(linear(1, upper, 0.05 * s.span()));
                    }
                    all.push(term(kind, free, &[(0, lower), (1, upper)]));
                }
            }
            all
        }
        "backlash" => {
            let rate = TAU * FLANK_FREQUENCY / s.period_s.max(FINE_PERIOD_S);
            let frictions = if rubs { &FREE_FRICTIONS[..] } else { &[0.5] };
            two_masses(PLAYS, PLAY_STARTS, |play| {
                let pairs = FREE_SHARES
                    .iter()
                    .flat_map(|&share| frictions.iter().map(move |&friction| (share, friction)));
                let start = |(share, friction): (f64, f64)| {
                    let reduced = m.inertia * share * (1.0 - share);
                    let mut free = vec![
                        log(0, play * s.span()),
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
        "compliance" => {
            let highest = HIGHEST_RESONANCE / s.period_s.max(FINE_PERIOD_S);
            let [low, high] = RESONANCES.map(|ratio| (ratio * s.motion_hz()).min(highest));
            let share = 0.5;
            two_masses([low, high], RESONANCE_STARTS, |hertz| {
                let k = (TAU * hertz).powi(2) * m.inertia * share * (1.0 - share);
                let mut free = vec![
                    log(0, k),
                    log(1, damped(k, m.inertia) * 0.5),
                    linear(2, share, 0.15),
                ];
                free.extend(rubs.then(|| linear(3, 0.5, 0.3)));
                vec![term(kind, free, &[])]
            })
        }
        "sensor_nonlinearity" => {
            let reach = s.position[0].abs().max(s.position[1].abs());
            let middle = 0.5 * (s.position[0] + s.position[1]);
            // A curve that is right at zero, or in the middle of what is passed.
            let bent = |middle: f64, reach: f64, [square, cube]: [f64; 2]| {
                let free = vec![
                    linear(0, square / reach, 0.2 / reach),
                    linear(1, cube / (reach * reach), 0.2 / (reach * reach)),
                ];
                term(kind, free, &[(6, middle)])
            };
            let mut all = vec![bent(0.0, reach, [0.0, 0.0])];
            all.extend(BENDS.map(|bend| bent(middle, 0.5 * s.span(), bend)));
            // An eccentric disk or poles show as a ripple, of which one period or a few are passed.
            for turns in [0.5, 1.0, 2.0] {
                let wave_number = turns * TAU / s.span();
                let amplitude = 0.1 / wave_number;
                let free = vec![
                    linear(2, 0.0, amplitude),
                    linear(3, amplitude, amplitude),
                    linear(4, wave_number, 0.2 * wave_number),
                ];
                all.push(term(kind, free, &[(0, 0.0), (1, 0.0)]));
            }
            all
        }
        "sensor_hysteresis" => each(&[3.0 * s.noise / s.span(), 0.02, 0.06], &|f| {
            vec![log(0, f * s.span())]
        }),
        "lost_counts" => jumps::starts(kind, e),
        "contact" => contact::starts(kind, e),
        _ => Vec::new(),
    }
}
