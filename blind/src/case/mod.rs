//! One case: a device, what is hidden in it, and recordings that show it.

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
use crate::scenario::{Cause, Family, Hidden, Plan, Plant, VOCABULARY};
use crate::session::{self, Logging};
use crate::truth::{Kind, Truth};
use amplitude::size_up;
use bench::Bench;
use logging::logging;
use messy::Dominant;
pub(crate) use numbers::effect_of;
pub use parts::SMALL_SHARE;
use secret::Secret;
use stated::{limit_input, narrow_travel, overstate, tolerance};
use strength::{hide, order_pair};
use timing::WrongTimes;
pub use transfer::Transfer;

/// The gap of what is hidden, in floors.
pub const GAP_OVER_FLOOR: [f64; 2] = [5.0, 100.0];
/// Steps of the simulation of the truth per period of the motion.
const FINE_STEPS: f64 = 40_000.0;
/// Devices drawn before giving up; a hundred in a row have never been needed.
const DEVICES: usize = 400;

/// A recording, a fresh one of the same device under another excitation, and the truth.
#[derive(Clone, Debug)]
pub struct Case {
    /// What the diagnosis sees.
    pub recording: Recording,
    /// For judging what it claims.
    pub fresh: Recording,
    /// The same device with another excitation, amplitude and load, where one was asked for and the device allows it.
    pub transfer: Option<Transfer>,
    /// What the scorer sees.
    pub truth: Truth,
}

/// Which kinds and names are drawn.
#[derive(Clone, Debug, Default)]
pub struct Mixture {
    /// Only this effect, or it as the dominant cause; `None` is the default mixture.
    pub only: Option<String>,
    /// Devices as real ones are: one dominant cause, several small ones, numbers that are off, wrong times.
    pub messy: bool,
    /// A third recording of each device, with another excitation, amplitude and load.
    pub transfer: bool,
}

/// No case could be made.
#[derive(Clone, Debug, thiserror::Error)]
pub enum CaseError {
    /// The effect is not one of the vocabulary.
    #[error("`{name}` is no effect; the names are: {}", VOCABULARY.join(", "))]
    UnknownEffect {
        /// What was asked for.
        name: String,
    },
    /// No draw satisfied the conditions.
    #[error("no device was found for case {case} of seed {seed}; take another seed")]
    Exhausted {
        /// Seed of the set.
        seed: u64,
        /// Number of the case.
        case: u64,
    },
}

impl Case {
    /// Case `case` of the set `seed`: the same for ever, whatever other cases are made.
    ///
    /// # Errors
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
            let dominant = match only {
                Some(name) => Dominant::Known(name),
                None => Dominant::draw(&mut draw),
            };
            return search(&mut draw, seed, case, |draw| {
                messy::attempt(draw, dominant, mixture.transfer)
            });
        }
        let kind = match only {
            Some(_) => Kind::Single,
            None => draw_kind(&mut draw),
        };
        let names = match kind {
            Kind::Single => vec![only.unwrap_or_else(|| draw.pick(&VOCABULARY))],
            Kind::Pair => pair(&mut draw),
            Kind::Nothing | Kind::Outside | Kind::Messy => Vec::new(),
        };
        search(&mut draw, seed, case, |draw| {
            attempt(draw, kind, &names, mixture.transfer)
        })
    }
}

/// The first device that suits.
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

/// Effects that cover each other by nature.
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

/// Whether two effects are the same or cover each other by nature.
pub fn alike(a: &str, b: &str) -> bool {
    a == b
        || ALIKE
            .iter()
            .any(|pair| pair.contains(&a) && pair.contains(&b))
}

/// Two effects that are not alike.
fn pair(draw: &mut Draw) -> Vec<&'static str> {
    loop {
        let pair = [draw.pick(&VOCABULARY), draw.pick(&VOCABULARY)];
        if !alike(pair[0], pair[1]) {
            return pair.to_vec();
        }
    }
}

/// Effects for which a second, good sensor of the same position says something.
const SENSING: [&str; 5] = [
    "sensor_gain",
    "sensor_nonlinearity",
    "sensor_hysteresis",
    "sensor_lag",
    "lost_counts",
];
/// Effects that are over when the recording is.
const BOUND_TO_A_MOMENT: [&str; 3] = ["contact", "push", "lost_counts"];

/// Whether motor and load are not at one place.
fn two_sided(names: &[&str]) -> bool {
    ["backlash", "compliance"]
        .iter()
        .any(|name| names.contains(name))
}

/// How predictions restart on `plant`; `wide` for a fit over more samples than usual.
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

fn attempt(draw: &mut Draw, kind: Kind, names: &[&'static str], transfers: bool) -> Option<Case> {
    let has = |wanted: &[&str]| names.iter().any(|name| wanted.contains(name));
    let mut plant = Plant::draw(draw, names);
    let mut secrets: Vec<Secret> = match kind {
        Kind::Outside => vec![Secret::Foreign(Cause::draw(draw, &plant))],
        _ => names
            .iter()
            .map(|name| Secret::Known(Hidden::draw(draw, name)))
            .collect(),
    };
    overstate(draw, &mut plant, &secrets);
    let logging = logging(draw, &plant, has(&SENSING), two_sided(names));
    let mut plans = Plan::session(draw, &plant);
    let scale = size_up(&mut plans, &plant, &logging)?;
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
    let (reality, measured) = hide(&bench, &mut secrets, &plans, &scale, wanted)?;
    if kind == Kind::Pair {
        order_pair(&bench, &mut secrets, &measured, &scale)?;
    }

    let mut fresh_plans = Plan::session(draw, &bench.plant);
    size_up(&mut fresh_plans, &bench.plant, &bench.logging)?;
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
