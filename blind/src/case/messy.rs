//! Draws a messy case, as real devices are: one dominant cause, several small causes, wrong stated numbers, and timing
//! errors.

use super::amplitude::set_amplitudes;
use super::bench::Bench;
use super::logging::logging;
use super::numbers::{self, WrongNumber};
use super::parts::{Part, Parts, Role, SMALL_SHARE, Settled, Source, settle};
use super::secret::Secret;
use super::stated::{limit_input, narrow_travel, overstate};
use super::timing::WrongTimes;
use super::transfer::transfer;
use super::{BOUND_TO_A_MOMENT, Case, GAP_OVER_FLOOR, SENSING, alike, restart, two_sided};
use crate::draw::Draw;
use crate::prediction::{self, HiddenStates};
use crate::reality::Reality;
use crate::scenario::{
    Cause, Family, Hidden, HiddenOwn, OwnEffect, Plan, Plant, Scale, VOCABULARY,
};
use crate::session::Log;
use crate::truth::{Effect, Kind, Timing, Truth};

/// Least and largest number of small causes.
pub(super) const SMALL_CAUSES: [usize; 2] = [3, 5];
/// Target size of a small cause over the size of the dominant one. It lies well within the accepted [`SMALL_SHARE`].
const AIMED_SHARE: [f64; 2] = [0.065, 0.2];
/// Probability that a small cause belongs to the vocabulary.
const SMALL_KNOWN: f64 = 0.7;
/// Probability that the dominant cause is a wrong stated number.
const NUMBER_DOMINATES: f64 = 0.15;
/// Probability that the dominant cause is outside the vocabulary.
const OUTSIDE_DOMINATES: f64 = 0.1;
/// Lowest and highest sampling rate of the log, rows per second.
const ROWS_HZ: [f64; 2] = [50.0, 10_000.0];
/// Fewest rows per period of the motion.
const LEAST_ROWS_PER_PERIOD: f64 = 40.0;
/// Longest and shortest period of the control loop, s.
const TICKS_S: [f64; 2] = [5e-3, 5e-5];

/// Class of the dominant cause of a case.
#[derive(Clone, Copy, Debug)]
pub(super) enum Dominant<'a> {
    /// An effect of the vocabulary.
    Known(&'static str),
    /// An effect of the user.
    Own(&'a OwnEffect),
    /// A cause that the vocabulary does not contain.
    Outside,
    /// A wrong stated number of the model.
    Number,
}

impl Dominant<'_> {
    pub fn draw(draw: &mut Draw) -> Self {
        match draw.uniform(0.0, 1.0) {
            x if x < NUMBER_DOMINATES => Self::Number,
            x if x < NUMBER_DOMINATES + OUTSIDE_DOMINATES => Self::Outside,
            _ => Self::Known(draw.pick(&VOCABULARY)),
        }
    }
}

/// Returns false if the two causes use the same part of the simulator, so that one device cannot have both.
fn compatible(a: &str, b: &str) -> bool {
    const ONE_PLACE: [&[&str]; 2] = [
        // A device has at most one compliant transmission.
        &["backlash", "compliance"],
        // A device has at most one external disturbance torque.
        &["torque_noise", "torque_bursts", "torque_tone"],
    ];
    a != b
        && !ONE_PLACE
            .iter()
            .any(|place| place.contains(&a) && place.contains(&b))
}

/// Draws the names of the small causes of the vocabulary, and the number of small causes outside it.
fn small_causes(draw: &mut Draw, dominant: Option<&'static str>) -> (Vec<&'static str>, usize) {
    let count = draw.count(SMALL_CAUSES[0], SMALL_CAUSES[1]);
    let known = (0..count).filter(|_| draw.chance(SMALL_KNOWN)).count();
    let mut names: Vec<&'static str> = Vec::new();
    while names.len() < known {
        let name = draw.pick(&VOCABULARY);
        let fits_dominant =
            dominant.is_none_or(|other| !alike(name, other) && compatible(name, other));
        if fits_dominant && names.iter().all(|other| compatible(name, other)) {
            names.push(name);
        }
    }
    (names, count - known)
}

/// Draws a cause outside the vocabulary that is compatible with `others`.
fn foreign(draw: &mut Draw, plant: &Plant, others: &[Secret]) -> Option<Secret> {
    const TRIES: usize = 30;
    (0..TRIES)
        .map(|_| Secret::Foreign(Cause::draw(draw, plant)))
        .find(|secret| {
            let mut names = others.iter().map(Secret::name);
            names.all(|name| compatible(name, secret.name()))
        })
}

/// Draws the sampling rate of the log, rows per second, and the number of control ticks per row.
fn rate(draw: &mut Draw, motion_hz: f64) -> (f64, usize) {
    let slowest = ROWS_HZ[0].max(LEAST_ROWS_PER_PERIOD * motion_hz);
    let rows_hz = draw.log_uniform(slowest, ROWS_HZ[1]);
    let mut ticks_per_row = draw.pick(&[1, 1, 2, 4, 8]);
    let tick_s = |ticks_per_row: usize| 1.0 / (rows_hz * ticks_per_row as f64);
    while tick_s(ticks_per_row) > TICKS_S[0] {
        ticks_per_row *= 2;
    }
    while ticks_per_row > 1 && tick_s(ticks_per_row) < TICKS_S[1] {
        ticks_per_row /= 2;
    }
    (rows_hz, ticks_per_row)
}

/// Draws one device with all its causes. Returns `None` if the causes cannot reach their target sizes on it.
pub(super) fn attempt(draw: &mut Draw, dominant: Dominant<'_>, transfers: bool) -> Option<Case> {
    let dominant_name = match dominant {
        Dominant::Known(name) => Some(name),
        Dominant::Own(_) | Dominant::Outside | Dominant::Number => None,
    };
    let (small, from_outside) = small_causes(draw, dominant_name);
    let names: Vec<&str> = dominant_name
        .into_iter()
        .chain(small.iter().copied())
        .collect();
    let mut plant = Plant::draw(draw, &names);
    let (rows_hz, ticks_per_row) = rate(draw, plant.motion_hz);
    plant.resample(rows_hz, ticks_per_row);

    let mut secrets: Vec<Secret> = match dominant {
        Dominant::Known(name) => vec![Secret::Known(Hidden::draw(draw, name))],
        Dominant::Own(own) => vec![Secret::Own(HiddenOwn::draw(draw, own))],
        Dominant::Outside => vec![Secret::Foreign(Cause::draw(draw, &plant))],
        Dominant::Number => Vec::new(),
    };
    let first_small = secrets.len();
    secrets.extend(
        small
            .iter()
            .map(|name| Secret::Known(Hidden::draw(draw, name))),
    );
    for _ in 0..from_outside {
        let secret = foreign(draw, &plant, &secrets)?;
        secrets.push(secret);
    }
    secrets[first_small..].iter_mut().for_each(Secret::weaken);

    overstate(draw, &mut plant, &secrets);
    let informative = names.iter().any(|name| SENSING.contains(name));
    let logging = logging(draw, &plant, informative, two_sided(&names));
    let mut plans = Plan::session(draw, &plant);
    let scale = set_amplitudes(&mut plans, &plant, &logging)?;
    limit_input(draw, &mut plant, &scale, &secrets);
    narrow_travel(draw, &mut plant, &scale, &secrets);

    let mut parts = Vec::new();
    let floors = draw.log_uniform(GAP_OVER_FLOOR[0] * 1.3, GAP_OVER_FLOOR[1] * 0.8);
    if let Dominant::Number = dominant {
        let off = numbers::dominant(draw, &plant.model, &names)?;
        parts.push(Part {
            cause: Source::Number(off),
            role: Role::Dominant(floors),
        });
    }
    for (k, secret) in secrets.into_iter().enumerate() {
        let share = draw.log_uniform(AIMED_SHARE[0], AIMED_SHARE[1]);
        parts.push(Part {
            cause: Source::Hidden(secret),
            role: if k < first_small {
                Role::Dominant(floors)
            } else {
                Role::Small(share)
            },
        });
    }
    let off = numbers::minor(draw, &plant.model, parts[0].name(), &names);
    parts.extend(off.into_iter().map(|off| Part {
        cause: Source::Number(off),
        role: Role::Number,
    }));
    let mut parts = Parts(parts);

    let wide = plant.family == Family::Servo && draw.chance(0.5);
    let mut bench = Bench {
        nominal: parts.nominal(&plant.model),
        tolerance: recording::Tolerance::default(),
        restart: restart(&plant, &logging, wide),
        per_run_clocks: !names.contains(&"friction_drift") && draw.chance(0.5),
        plant,
        logging,
    };
    let Settled {
        reality,
        measured,
        sizes,
    } = settle(&mut bench, &mut parts, &plans, &scale)?;
    let off: Vec<WrongNumber> = parts.off().copied().collect();
    bench.tolerance = numbers::tolerance(draw, &bench.plant.model, &off);

    let (times, timing_size) = wrong_times(draw, &bench, &reality, &measured.logs, sizes[0]);
    let times = times.stated(draw);
    let recording = bench.recording_with_timing(&plans, &measured.logs, times, draw);
    let mut fresh_plans = Plan::session(draw, &bench.plant);
    set_amplitudes(&mut fresh_plans, &bench.plant, &bench.logging)?;
    let fresh = bench.measure(&reality, &fresh_plans, &scale)?;
    let shows = fresh.reference.before > GAP_OVER_FLOOR[0] * fresh.reference.after;
    let lasts = !BOUND_TO_A_MOMENT.contains(&parts.0[0].name());
    let transferred = transfers
        .then(|| transfer(draw, &bench, &reality, times))
        .flatten();

    let timing = Timing {
        offset_rows: times.offset_rows,
        point_sampled: times.point_sampled,
        stamp_std_rows: times.stamp_std_rows,
        share: timing_size / sizes[0],
    };
    Some(Case {
        recording,
        fresh: bench.recording_with_timing(&fresh_plans, &fresh.logs, times, draw),
        truth: Truth {
            seed: 0,
            case: 0,
            kind: Kind::Messy,
            device: format!("{:?} {:?}", bench.plant.family, bench.plant.model),
            effects: effects(&bench, &parts, &sizes, &scale, times, timing),
            reference: measured.reference,
            fresh_floor: (shows && lasts).then_some(fresh.reference.after),
            transfer_floor: transferred
                .as_ref()
                .and_then(|transferred| transferred.floor.filter(|_| lasts)),
            timing: Some(timing),
        },
        transfer: transferred,
    })
}

/// Draws timing errors that change the prediction by no more than a small cause may. Returns them with the rms change that
/// they cause.
fn wrong_times(
    draw: &mut Draw,
    bench: &Bench,
    reality: &Reality,
    logs: &[Log],
    dominant_size: f64,
) -> (WrongTimes, f64) {
    const TRIES: usize = 12;
    let predict = |logs: &[Log]| {
        let step_s = bench.prediction_step_s(reality);
        prediction::predict(reality, logs, bench.restart, HiddenStates::Carried, step_s)
    };
    let right = predict(logs);
    let seed = draw.seed();
    let size = |times: WrongTimes| {
        let written = times.apply_all(logs, &mut Draw::seeded(seed));
        prediction::difference(&right, &predict(&written))
    };
    let mut times = WrongTimes::draw(draw);
    for _ in 0..TRIES {
        let size = size(times);
        if size <= SMALL_SHARE[1] * dominant_size {
            return (times, size);
        }
        times = times.milder();
    }
    (WrongTimes::NONE, 0.0)
}

/// The true causes: the dominant one first, then the others by decreasing size.
fn effects(
    bench: &Bench,
    parts: &Parts,
    sizes: &[f64],
    scale: &Scale,
    times: WrongTimes,
    timing: Timing,
) -> Vec<Effect> {
    let mut effects: Vec<Effect> = parts
        .0
        .iter()
        .zip(sizes)
        .map(|(part, size)| {
            let effect = match &part.cause {
                Source::Hidden(secret) => bench.describe(secret, scale),
                Source::Number(off) => Effect {
                    name: off.effect.into(),
                    strength: off.relative,
                    form: format!("stated {} over the true one, less 1", off.number),
                    places: Vec::new(),
                    share: None,
                },
            };
            Effect {
                share: Some(size / sizes[0]),
                ..effect
            }
        })
        .collect();
    // An input that acts later than its column says is a delay. So is one that acts earlier than a stated delay.
    let rows = times.apparent_delay_rows();
    let is_delay = rows > 0.0 || bench.plant.model.delay > 0.0;
    if is_delay && timing.share >= SMALL_SHARE[0] && effects.iter().all(|e| e.name != "delay") {
        effects.push(Effect {
            name: "delay".into(),
            strength: rows,
            form: "time between the input and the position column, rows".into(),
            places: Vec::new(),
            share: Some(timing.share),
        });
    }
    let share = |effect: &Effect| effect.share.unwrap_or(0.0);
    effects[1..].sort_by(|a, b| share(b).total_cmp(&share(a)));
    effects
}
