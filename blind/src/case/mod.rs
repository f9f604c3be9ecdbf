//! Makes one case: a device, the causes hidden in it, and recordings that show them.

mod amplitude;
mod bench;
mod logging;
mod messy;
mod numbers;
mod parts;
mod secret;
mod stated;
mod strength;
mod timing;
mod transfer;

use recording::Recording;

use crate::draw::Draw;
use crate::prediction::Restart;
use crate::scenario::{Cause, Family, Hidden, HiddenOwn, OwnEffect, Plan, Plant, VOCABULARY};
use crate::session::{self, Logging};
use crate::truth::{Kind, Truth};
use amplitude::set_amplitudes;
use bench::Bench;
use logging::logging;
use messy::Dominant;
pub(crate) use numbers::effect_of;
pub use parts::SMALL_SHARE;
use secret::Secret;
use stated::{limit_input, narrow_travel, overstate, tolerance};
use strength::{adjust_strengths, order_pair};
use timing::WrongTimes;
pub use transfer::Transfer;

/// Least and largest gap that the hidden causes make, over the floor.
pub const GAP_OVER_FLOOR: [f64; 2] = [5.0, 100.0];
/// Steps per period of the motion in the simulation of the true device.
const FINE_STEPS: f64 = 40_000.0;
/// Number of devices drawn before a case is given up.
const DEVICES: usize = 400;

/// A recording, a second recording of the same device under another excitation, and the truth.
#[derive(Clone, Debug)]
pub struct Case {
    /// The recording that the diagnosis reads.
    pub recording: Recording,
    /// The recording on which the claims of the diagnosis are tested.
    pub fresh: Recording,
    /// A recording of the same device with another excitation, amplitude and load. `None` if it was not asked for or the
    /// device does not allow it.
    pub transfer: Option<Transfer>,
    /// The truth, which only the scorer reads.
    pub truth: Truth,
}

/// Which kinds of cases and which effects are drawn.
#[derive(Clone, Debug, Default)]
pub struct Mixture {
    /// The only effect to draw. In messy cases it is the dominant cause. `None` draws all effects.
    pub only: Option<String>,
    /// An effect of the user to hide in every case instead. In messy cases it is the dominant cause.
    pub own: Option<OwnEffect>,
    /// If true, cases have one dominant cause, several small causes, wrong stated numbers and timing errors.
    pub messy: bool,
    /// If true, each case has a third recording with another excitation, amplitude and load.
    pub transfer: bool,
}

/// Why a case could not be made.
#[derive(Clone, Debug, thiserror::Error)]
pub enum CaseError {
    /// The requested effect is not in the vocabulary.
    #[error("`{name}` is no effect; the names are: {}", VOCABULARY.join(", "))]
    UnknownEffect {
        /// The requested name.
        name: String,
    },
    /// No drawn device satisfied the conditions.
    #[error("no device was found for case {case} of seed {seed}; take another seed")]
    Exhausted {
        /// Seed of the set.
        seed: u64,
        /// Number of the case.
        case: u64,
    },
}

impl Case {
    /// Makes case number `case` of the set with seed `seed`. The result depends on these two numbers and on `mixture` only,
    /// not on which other cases are made.
    ///
    /// # Errors
    ///
    /// [`CaseError`].
    pub fn make(seed: u64, case: u64, mixture: &Mixture) -> Result<Self, CaseError> {
        let mut draw = Draw::of_case(seed, case);
        let only = match &mixture.only {
            None => None,
            Some(name) => Some(
                *VOCABULARY
                    .iter()
                    .find(|known| *known == name)
                    .ok_or_else(|| CaseError::UnknownEffect { name: name.clone() })?,
            ),
        };
        if mixture.messy {
            let dominant = match (&mixture.own, only) {
                (Some(own), _) => Dominant::Own(own),
                (None, Some(name)) => Dominant::Known(name),
                (None, None) => Dominant::draw(&mut draw),
            };
            return search(&mut draw, seed, case, |draw| {
                messy::attempt(draw, dominant, mixture.transfer)
            });
        }
        let own = mixture.own.as_ref();
        let kind = if own.is_some() || only.is_some() {
            Kind::Single
        } else {
            draw_kind(&mut draw)
        };
        let names = match kind {
            Kind::Single if own.is_some() => Vec::new(),
            Kind::Single => vec![only.unwrap_or_else(|| draw.pick(&VOCABULARY))],
            Kind::Pair => pair(&mut draw),
            Kind::Nothing | Kind::Outside | Kind::Messy => Vec::new(),
        };
        search(&mut draw, seed, case, |draw| {
            attempt(draw, kind, &names, own, mixture.transfer)
        })
    }
}

/// Draws devices until one satisfies the conditions of its kind.
fn search(
    draw: &mut Draw,
    seed: u64,
    case: u64,
    attempt: impl Fn(&mut Draw) -> Option<Case>,
) -> Result<Case, CaseError> {
    for _ in 0..DEVICES {
        if let Some(mut found) = attempt(&mut draw.split()) {
            found.truth.seed = seed;
            found.truth.case = case;
            return Ok(found);
        }
    }
    Err(CaseError::Exhausted { seed, case })
}

fn draw_kind(draw: &mut Draw) -> Kind {
    match draw.uniform(0.0, 1.0) {
        x if x < 0.65 => Kind::Single,
        x if x < 0.75 => Kind::Pair,
        x if x < 0.85 => Kind::Nothing,
        _ => Kind::Outside,
    }
}

/// Pairs of effects that cannot be separated in principle.
const ALIKE: [[&str; 2]; 12] = [
    ["torque_gain", "inertia"],
    ["torque_gain", "sensor_gain"],
    ["inertia", "sensor_gain"],
    ["torque_offset", "asymmetric_coulomb"],
    ["coulomb", "asymmetric_coulomb"],
    ["gravity", "spring"],
    ["lag", "delay"],
    ["lag", "sensor_lag"],
    ["delay", "sensor_lag"],
    ["viscous", "quadratic_drag"],
    ["stribeck", "presliding"],
    ["backlash", "compliance"],
];

/// Returns true if the two effects are equal or cannot be separated in principle.
pub fn alike(a: &str, b: &str) -> bool {
    a == b
        || ALIKE
            .iter()
            .any(|pair| pair.contains(&a) && pair.contains(&b))
}

/// Draws two effects that can be separated.
fn pair(draw: &mut Draw) -> Vec<&'static str> {
    loop {
        let pair = [draw.pick(&VOCABULARY), draw.pick(&VOCABULARY)];
        if !alike(pair[0], pair[1]) {
            return pair.to_vec();
        }
    }
}

/// Effects that a second, unaffected sensor of the same position helps to identify.
const SENSING: [&str; 5] = [
    "sensor_gain",
    "sensor_nonlinearity",
    "sensor_hysteresis",
    "sensor_lag",
    "lost_counts",
];
/// Effects that act during part of one recording only, so that another recording does not show them.
const BOUND_TO_A_MOMENT: [&str; 3] = ["contact", "push", "lost_counts"];

/// Returns true if an effect needs separate motor and load inertias.
fn two_sided(names: &[&str]) -> bool {
    ["backlash", "compliance"]
        .iter()
        .any(|name| names.contains(name))
}

/// How predictions on `plant` restart. With `wide`, the fit uses more samples than usual.
fn restart(plant: &Plant, logging: &Logging, wide: bool) -> Restart {
    Restart {
        horizon_s: plant.horizon_s,
        half_width_s: if wide {
            0.02
        } else {
            Recording::RESTART_HALF_WIDTH
        },
        logged_gain: logging.logged_gain,
        logged_lag_s: plant.tick_s * (1.0 - logging.logged_gain) / logging.logged_gain,
    }
}

fn attempt(
    draw: &mut Draw,
    kind: Kind,
    names: &[&'static str],
    own: Option<&OwnEffect>,
    transfers: bool,
) -> Option<Case> {
    let has = |wanted: &[&str]| names.iter().any(|name| wanted.contains(name));
    let mut plant = Plant::draw(draw, names);
    let mut secrets: Vec<Secret> = match (kind, own) {
        (_, Some(own)) => vec![Secret::Own(HiddenOwn::draw(draw, own))],
        (Kind::Outside, None) => vec![Secret::Foreign(Cause::draw(draw, &plant))],
        _ => names
            .iter()
            .map(|name| Secret::Known(Hidden::draw(draw, name)))
            .collect(),
    };
    overstate(draw, &mut plant, &secrets);
    let logging = logging(draw, &plant, has(&SENSING), two_sided(names));
    let mut plans = Plan::session(draw, &plant);
    let scale = set_amplitudes(&mut plans, &plant, &logging)?;
    limit_input(draw, &mut plant, &scale, &secrets);
    narrow_travel(draw, &mut plant, &scale, &secrets);
    let tolerance = tolerance(draw, &plant, &secrets);
    let nominal = session::nominal(&plant.model, &tolerance, draw);
    let wide = plant.family == Family::Servo && draw.chance(0.5);
    let restart = restart(&plant, &logging, wide);
    let per_run_clocks = !has(&["friction_drift"]) && draw.chance(0.5);
    let bench = Bench {
        plant,
        nominal,
        tolerance,
        logging,
        restart,
        per_run_clocks,
    };

    let wanted = draw.log_uniform(GAP_OVER_FLOOR[0] * 1.3, GAP_OVER_FLOOR[1] * 0.8);
    let (reality, measured) = adjust_strengths(&bench, &mut secrets, &plans, &scale, wanted)?;
    if kind == Kind::Pair {
        order_pair(&bench, &mut secrets, &measured, &scale)?;
    }

    let mut fresh_plans = Plan::session(draw, &bench.plant);
    set_amplitudes(&mut fresh_plans, &bench.plant, &bench.logging)?;
    let fresh = bench.measure(&reality, &fresh_plans, &scale)?;
    let shows = fresh.reference.hidden_alone > GAP_OVER_FLOOR[0] * fresh.reference.after;
    let lasts = !has(&BOUND_TO_A_MOMENT);
    let transfer = transfers
        .then(|| transfer::transfer(draw, &bench, &reality, WrongTimes::NONE))
        .flatten();

    Some(Case {
        recording: bench.recording(&plans, &measured.logs),
        fresh: bench.recording(&fresh_plans, &fresh.logs),
        truth: Truth {
            seed: 0,
            case: 0,
            kind,
            device: format!("{:?} {:?}", bench.plant.family, bench.plant.model),
            effects: secrets
                .iter()
                .map(|secret| bench.describe(secret, &scale))
                .collect(),
            reference: measured.reference,
            fresh_floor: (shows && lasts).then_some(fresh.reference.after),
            transfer_floor: transfer
                .as_ref()
                .and_then(|transfer| transfer.floor.filter(|_| lasts)),
            timing: None,
        },
        transfer,
    })
}
