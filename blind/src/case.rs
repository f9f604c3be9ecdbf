//! One case: a device, what is hidden in it, and recordings that show it.

use recording::{Model, Recording, Sensor, Tolerance, low_pass_gain};

use crate::draw::Draw;
use crate::prediction::{self, HiddenStates, Restart};
use crate::reality::Reality;
use crate::scenario::{Cause, Drive, Family, Hidden, Plan, Plant, Scale, VOCABULARY};
use crate::session::{self, Log, Logging, SECOND_COLUMN};
use crate::truth::{Effect, Kind, Reference, Truth};

/// The gap of what is hidden, in floors.
pub const GAP_OVER_FLOOR: [f64; 2] = [5.0, 100.0];
/// What is hidden must outweigh the tolerances by this.
const OVER_TOLERANCES: f64 = 3.0;
/// Each of a pair must show at least this many floors by itself.
const PAIR_SHARE_OVER_FLOOR: f64 = 3.0;
/// A motion is grossly different if its span changes by more than this.
const SPAN_CHANGE: f64 = 4.0;
/// Steps of the simulation of the truth, a predicted one, and a rough one, per period of the motion.
const FINE_STEPS: f64 = 40_000.0;
const PREDICTION_STEPS: f64 = 20_000.0;
const COARSE_STEPS: f64 = 4_000.0;
const ADJUSTMENTS: usize = 6;
/// Devices drawn before giving up; a hundred in a row have never been needed.
const DEVICES: usize = 400;

/// A recording, a fresh one of the same device under another excitation, and the truth.
#[derive(Clone, Debug)]
pub struct Case {
    /// What the diagnosis sees.
    pub recording: Recording,
    /// For judging what it claims.
    pub fresh: Recording,
    /// What the scorer sees.
    pub truth: Truth,
}

/// Which kinds and names are drawn.
#[derive(Clone, Debug, Default)]
pub struct Mixture {
    /// Only this effect; `None` is the default mixture.
    pub only: Option<String>,
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
        let kind = match &mixture.only {
            Some(_) => Kind::Single,
            None => draw_kind(&mut draw),
        };
        let only = match &mixture.only {
            None => None,
            Some(name) => Some(
                *VOCABULARY
                    .iter()
                    .find(|known| *known == name)
                    .ok_or_else(|| CaseError::UnknownEffect { name: name.clone() })?,
            ),
        };
        let names = match kind {
            Kind::Single => vec![only.unwrap_or_else(|| draw.pick(&VOCABULARY))],
            Kind::Pair => pair(&mut draw),
            Kind::Nothing | Kind::Outside => Vec::new(),
        };
        for _ in 0..DEVICES {
            if let Some(mut found) = attempt(&mut draw.split(), kind, &names) {
                found.truth.seed = seed;
                found.truth.case = case;
                return Ok(found);
            }
        }
        Err(CaseError::Exhausted { seed, case })
    }
}

fn draw_kind(draw: &mut Draw) -> Kind {
    match draw.uniform(0.0, 1.0) {
        x if x < 0.65 => Kind::Single,
        x if x < 0.75 => Kind::Pair,
        x if x < 0.85 => Kind::Nothing,
        _ => Kind::Outside,
    }
}

/// Two effects that do not cover each other by nature.
fn pair(draw: &mut Draw) -> Vec<&'static str> {
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
    loop {
        let pair = [draw.pick(&VOCABULARY), draw.pick(&VOCABULARY)];
        let alike = ALIKE
            .iter()
            .any(|[a, b]| pair == [*a, *b] || pair == [*b, *a]);
        if pair[0] != pair[1] && !alike {
            return pair.to_vec();
        }
    }
}

/// What is hidden, whichever kind it is of.
#[derive(Clone, Debug)]
enum Secret {
    Known(Hidden),
    Foreign(Cause),
}

impl Secret {
    fn apply(&self, reality: &mut Reality, scale: &Scale) {
        match self {
            Self::Known(hidden) => hidden.apply(reality, scale),
            Self::Foreign(cause) => cause.apply(reality, scale),
        }
    }

    /// Multiplies the strength by `factor`; `false` if that hits the end of its range.
    fn scale_by(&mut self, factor: f64) -> bool {
        let (strength, [low, high]) = match self {
            Self::Known(hidden) => (&mut hidden.strength, hidden.range),
            Self::Foreign(cause) => (&mut cause.strength, cause.range),
        };
        let before = *strength;
        *strength = (*strength * factor).clamp(low, high);
        (*strength / before - 1.0).abs() > 0.01
    }

    fn describe(&self, scale: &Scale) -> Effect {
        let (name, strength, places, form) = match self {
            Self::Known(hidden) => (
                hidden.name,
                hidden.strength,
                hidden.places(scale),
                format!("{hidden:?}"),
            ),
            Self::Foreign(cause) => (
                cause.name,
                cause.strength,
                cause.places(scale),
                format!("{cause:?}"),
            ),
        };
        Effect {
            name: name.into(),
            strength,
            form,
            places,
        }
    }
}

/// A device with its plans, ready to hide something in.
struct Bench {
    plant: Plant,
    nominal: Model,
    tolerance: Tolerance,
    logging: Logging,
    restart: Restart,
    /// Whether time starts anew in every run.
    per_run_clocks: bool,
}

/// One session measured against the truth.
struct Measured {
    logs: Vec<Log>,
    reference: Reference,
}

impl Bench {
    fn prediction_step_s(&self, reality: &Reality) -> f64 {
        // A transmission that is not rigid is the stiffest part.
        let steps = match reality.mechanics.coupling {
            Some(_) => FINE_STEPS,
            None => PREDICTION_STEPS,
        };
        1.0 / (steps * self.plant.motion_hz)
    }

    fn plain(&self) -> Reality {
        Reality::plain(&self.plant.model)
    }

    /// Carries out `plans` on `reality` and measures the gaps; `None` if the motion makes no sense.
    fn measure(&self, reality: &Reality, plans: &[Plan], scale: &Scale) -> Option<Measured> {
        let logs = session::carry_out(reality, plans, &self.logging);
        let sensible = logs.iter().all(|log| {
            let (low, high) = session::extremes(&log.position);
            let half = 0.5 * (high - low);
            half.is_finite()
                && half < SPAN_CHANGE * scale.half_span
                && half > 20.0 * self.plant.sensor.resolution.max(self.plant.sensor.noise)
                && low.abs().max(high.abs()) < 4.0 * SPAN_CHANGE * scale.half_span
        });
        if !sensible {
            return None;
        }
        let predict = |model: &Reality, hidden| {
            let step_s = self.prediction_step_s(model);
            prediction::predict(model, &logs, self.restart, hidden, step_s)
        };
        let plain = predict(&self.plain(), HiddenStates::Carried);
        let nominal = predict(&Reality::plain(&self.nominal), HiddenStates::Carried);
        let true_model = predict(reality, HiddenStates::Known);
        let reference = Reference {
            before: prediction::gap(&logs, &nominal),
            after: prediction::gap(&logs, &true_model),
            hidden_alone: prediction::gap(&logs, &plain),
            tolerances_alone: prediction::difference(&nominal, &plain),
        };
        reference
            .before
            .is_finite()
            .then_some(Measured { logs, reference })
    }

    /// The truth about `secret`, with times as the recording's column has them.
    fn describe(&self, secret: &Secret, scale: &Scale) -> Effect {
        let mut effect = secret.describe(scale);
        for place in &mut effect.places {
            if let (true, "time", Some(run)) = (self.per_run_clocks, place.axis.as_str(), place.run)
            {
                let origin = scale.runs_s[run][0];
                for end in [&mut place.from, &mut place.to] {
                    *end = end.map(|time_s| time_s - origin);
                }
            }
        }
        effect
    }

    fn recording(&self, plans: &[Plan], logs: &[Log]) -> Recording {
        let mut recording = Recording::new("A device", self.plant.horizon_s, self.nominal);
        recording.restart_half_width = self.restart.half_width_s;
        recording.units = self.plant.units.clone();
        recording.tolerance = self.tolerance.clone();
        recording
            .sensors
            .insert("position".into(), self.plant.sensor);
        if let Some(second) = self.logging.second {
            recording.sensors.insert(SECOND_COLUMN.into(), second);
        }
        recording.runs = plans
            .iter()
            .zip(logs)
            .enumerate()
            .map(|(k, (plan, log))| {
                log.run(plan, &format!("run-{}.csv", k + 1), self.per_run_clocks)
            })
            .collect();
        recording
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
const BOUND_TO_A_MOMENT: [&str; 2] = ["contact", "lost_counts"];

fn attempt(draw: &mut Draw, kind: Kind, names: &[&'static str]) -> Option<Case> {
    let has = |wanted: &[&str]| names.iter().any(|name| wanted.contains(name));
    let mut plant = Plant::draw(draw, names);
    let mut secrets: Vec<Secret> = match kind {
        Kind::Outside => vec![Secret::Foreign(Cause::draw(draw, &plant))],
        _ => names
            .iter()
            .map(|name| Secret::Known(Hidden::draw(draw, name)))
            .collect(),
    };
    let logging = logging(
        draw,
        &plant,
        has(&SENSING),
        has(&["backlash", "compliance"]),
    );
    let mut plans = Plan::session(draw, &plant);
    let scale = size_up(&mut plans, &plant, &logging)?;
    limit_input(draw, &mut plant, &scale, has(&["saturation"]));
    let tolerance = tolerance(draw, &plant, &secrets);
    let nominal = session::nominal(&plant.model, &tolerance, draw);
    let wide = plant.family == Family::Servo && draw.chance(0.5);
    let restart = Restart {
        horizon_s: plant.horizon_s,
        half_width_s: if wide {
            0.02
        } else {
            Recording::RESTART_HALF_WIDTH
        },
        logged_gain: logging.logged_gain,
        logged_lag_s: plant.tick_s * (1.0 - logging.logged_gain) / logging.logged_gain,
    };
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
            fresh_floor: (shows && !has(&BOUND_TO_A_MOMENT)).then_some(fresh.reference.after),
        },
    })
}

fn logging(draw: &mut Draw, plant: &Plant, decides: bool, two_sided: bool) -> Logging {
    let coarser = draw.log_uniform(1.0, 4.0);
    let second = Sensor {
        resolution: 0.0,
        noise: coarser * plant.sensor.noise.max(plant.sensor.resolution / 3.0),
        cutoff_hz: None,
    };
    let there = draw.chance(if decides { 0.4 } else { 0.15 }) && !two_sided;
    Logging {
        sensor: plant.sensor,
        logged_gain: low_pass_gain(plant.sensor.cutoff_hz, plant.tick_s),
        filters_noise: draw.chance(0.7),
        second: there.then_some(second),
        horizon_s: plant.horizon_s,
        step_s: 1.0 / (FINE_STEPS * plant.motion_hz),
        start: plant.model.gravity_zero,
        grain: plant.amplitude * 1e-8,
    }
}

/// Sets the amplitudes of open-loop runs so that the device moves as far as it should, and gives the scale of it all.
fn size_up(plans: &mut [Plan], plant: &Plant, logging: &Logging) -> Option<Scale> {
    let plain = Reality::plain(&plant.model);
    let coarse = Logging {
        step_s: 1.0 / (COARSE_STEPS * plant.motion_hz),
        second: None,
        ..logging.clone()
    };
    let half_span = |plan: &Plan| {
        let log = session::carry_out(&plain, std::slice::from_ref(plan), &coarse).remove(0);
        let (low, high) = session::extremes(&log.position);
        0.5 * (high - low)
    };
    for plan in plans.iter_mut() {
        let Drive::Open {
            amplitude: wanted, ..
        } = plan.drive
        else {
            continue;
        };
        let model = &plant.model;
        let most =
            (model.coulomb + model.gravity + model.stiffness * wanted + 4.0 * plant.torque())
                / model.ratio;
        let (mut low, mut high) = (0.02 * most, 2.0 * most);
        for _ in 0..8 {
            let middle = f64::sqrt(low * high);
            if let Drive::Open { amplitude, .. } = &mut plan.drive {
                *amplitude = middle;
            }
            if half_span(plan) > wanted {
                high = middle
            } else {
                low = middle
            }
        }
        let reached = half_span(plan);
        if !(0.4 * wanted..2.5 * wanted).contains(&reached) {
            return None;
        }
    }
    let logs = session::carry_out(&plain, plans, &coarse);
    let scale = session::scale(&logs, plant.model.ratio, plant.motion_hz, &plant.sensor);
    (scale.half_span.is_finite() && scale.half_span > 0.3 * plant.amplitude && scale.speed > 0.0)
        .then_some(scale)
}

/// States a limit of the input on some devices, mostly one that is never met.
fn limit_input(draw: &mut Draw, plant: &mut Plant, scale: &Scale, generous: bool) {
    if draw.chance(0.5) {
        let factor = if generous {
            draw.uniform(1.2, 2.5)
        } else {
            draw.log_uniform(0.8, 2.5)
        };
        let limit = scale.input * factor;
        let digits = 10f64.powi(3 - limit.log10().floor() as i32);
        plant.model.input_limit = Some((limit * digits).round() / digits);
    }
}

/// What is stated about the nominal numbers.
fn tolerance(draw: &mut Draw, plant: &Plant, secrets: &[Secret]) -> Tolerance {
    let mut tolerance = Tolerance::default();
    if !draw.chance(0.6) {
        return tolerance;
    }
    let usual = [
        ("inertia", 0.005, 0.03),
        ("viscous", 0.05, 0.3),
        ("coulomb", 0.02, 0.15),
        ("gravity", 0.01, 0.05),
        ("stiffness", 0.01, 0.05),
        ("ratio", 0.003, 0.02),
    ];
    for (name, low, high) in usual {
        let relative = draw.log_uniform(low, high);
        let touched = secrets.iter().any(|secret| match secret {
            Secret::Known(hidden) => hidden.touches().contains(&name),
            Secret::Foreign(_) => false,
        });
        // What is hidden in a number must lie far outside what is stated about it.
        let relative = if touched { low } else { relative };
        if plant.model.get(name).is_some_and(|value| value != 0.0) && draw.chance(0.8) {
            tolerance.set(name, (relative * 1e4).round() / 1e4);
        }
    }
    tolerance
}

/// Adjusts the strengths until the gap is about `wanted` floors; `None` if it stays out of range.
fn hide(
    bench: &Bench,
    secrets: &mut [Secret],
    plans: &[Plan],
    scale: &Scale,
    wanted: f64,
) -> Option<(Reality, Measured)> {
    for _ in 0..ADJUSTMENTS {
        let mut reality = bench.plain();
        for secret in secrets.iter() {
            secret.apply(&mut reality, scale);
        }
        let Some(measured) = bench.measure(&reality, plans, scale) else {
            if secrets.is_empty() {
                return None;
            }
            secrets.iter_mut().for_each(|secret| {
                secret.scale_by(0.5);
            });
            continue;
        };
        if secrets.is_empty() {
            return Some((reality, measured));
        }
        let Reference {
            before,
            after,
            hidden_alone,
            tolerances_alone,
        } = measured.reference;
        let floors = hidden_alone / after;
        let in_range = |gap: f64| (GAP_OVER_FLOOR[0]..GAP_OVER_FLOOR[1]).contains(&(gap / after));
        if in_range(hidden_alone)
            && in_range(before)
            && hidden_alone > OVER_TOLERANCES * tolerances_alone
        {
            return Some((reality, measured));
        }
        let target = wanted
            .max(1.2 * OVER_TOLERANCES * tolerances_alone / after)
            .min(80.0);
        let factor = (target / floors).clamp(0.1, 10.0);
        let mut moved = false;
        for secret in secrets.iter_mut() {
            moved |= secret.scale_by(factor);
        }
        if !moved {
            return None;
        }
    }
    None
}

/// Puts the effect that contributes more first; `None` if one of them hardly shows.
fn order_pair(
    bench: &Bench,
    secrets: &mut [Secret],
    measured: &Measured,
    scale: &Scale,
) -> Option<()> {
    let without = |k: usize| {
        let mut reality = bench.plain();
        for (other, secret) in secrets.iter().enumerate() {
            if other != k {
                secret.apply(&mut reality, scale);
            }
        }
        let step_s = bench.prediction_step_s(&reality);
        let predicted = prediction::predict(
            &reality,
            &measured.logs,
            bench.restart,
            HiddenStates::Carried,
            step_s,
        );
        prediction::gap(&measured.logs, &predicted)
    };
    let [first, second] = [without(0), without(1)];
    if first.min(second) < PAIR_SHARE_OVER_FLOOR * measured.reference.after {
        return None;
    }
    if second > first {
        secrets.swap(0, 1);
    }
    Some(())
}
