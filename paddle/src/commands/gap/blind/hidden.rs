//! Draws a paddle of the lab's size with hidden effects.

use crate::failure::Failure;
use blind::{Draw, GAP_OVER_FLOOR, SMALL_SHARE, alike};
use gap::{Device, Effect, Model, Recording, measure};
use haptic_paddle::controller::Mode;
use haptic_paddle::excitation::Excitation;
use haptic_paddle::settings::Settings;
use host_sim::closed_loop::{ClosedLoop, LoopSetup};
use host_sim::experiment::{Experiment, recording};
use host_sim::presets;
use remote::Plan;

/// Distribution of a drawn number.
#[derive(Clone, Copy)]
enum Spread {
    /// Uniform between these limits.
    Even(f64, f64),
    /// Uniform in the logarithm between two positive limits.
    Log(f64, f64),
    /// As `Log`, with a random sign.
    Either(f64, f64),
}

use Spread::{Either, Even, Log};

/// Distributions of the parameters of an effect. Parameters without a distribution keep their default values.
struct Recipe {
    name: &'static str,
    /// The parameter that sets the strength of the effect.
    strength: (&'static str, Spread),
    /// Value of that parameter at which the effect does nothing. `None` for effects that are never drawn small.
    neutral: Option<f64>,
    /// The other drawn parameters.
    form: &'static [(&'static str, Spread)],
}

const fn recipe(
    name: &'static str,
    strength: (&'static str, Spread),
    neutral: Option<f64>,
    form: &'static [(&'static str, Spread)],
) -> Recipe {
    Recipe {
        name,
        strength,
        neutral,
        form,
    }
}

/// Share of the inertia on the load side of a flexible transmission.
const LOAD: (&str, Spread) = ("load_share", Even(0.2, 0.6));

/// Every effect of the library, in SI units at the paddle, or at the motor for drive effects. An effect that occurs at one
/// time occurs during the first experiment.
#[rustfmt::skip]
const RECIPES: [Recipe; 31] = [
    recipe("torque_gain", ("gain", Log(0.6, 1.6)), None, &[]),
    recipe("torque_offset", ("torque", Either(0.002, 0.02)), Some(0.0), &[]),
    recipe("deadband", ("width", Log(1e-4, 1e-3)), Some(0.0), &[]),
    recipe("saturation", ("limit", Log(0.0012, 0.003)), None, &[]),
    recipe("input_nonlinearity", ("power", Log(0.6, 1.8)), Some(1.0), &[]),
    recipe("lag", ("time", Log(0.001, 0.02)), Some(0.0), &[]),
    recipe("delay", ("time", Log(0.001, 0.02)), Some(0.0), &[]),
    recipe("cogging", ("amplitude", Log(0.002, 0.02)), Some(0.0),
        &[("wave_number", Log(15.0, 120.0)), ("phase", Even(-3.1, 3.1))]),
    recipe("coulomb", ("level", Log(0.005, 0.03)), None, &[]),
    recipe("asymmetric_coulomb", ("positive", Log(0.006, 0.035)), None, &[]),
    recipe("position_dependent_coulomb", ("slope", Either(0.5, 2.0)), Some(0.0), &[]),
    recipe("stribeck", ("static_ratio", Log(1.2, 2.2)), Some(1.0), &[("velocity", Log(0.05, 0.5))]),
    recipe("viscous", ("coefficient", Log(0.001, 0.02)), None, &[]),
    recipe("quadratic_drag", ("coefficient", Log(1e-4, 3e-3)), Some(0.0), &[]),
    recipe("presliding", ("distance", Log(0.004, 0.04)), Some(0.0), &[]),
    recipe("load_dependent_friction", ("share", Log(0.05, 0.4)), Some(0.0), &[]),
    recipe("friction_drift", ("rate", Log(0.01, 0.1)), Some(0.0), &[("settling", Log(5.0, 20.0))]),
    recipe("inertia", ("inertia", Log(3.5e-4, 1e-3)), None, &[]),
    recipe("gravity", ("weight", Log(0.005, 0.06)), None, &[]),
    recipe("spring", ("stiffness", Log(0.01, 0.15)), Some(0.0), &[("zero", Even(-0.2, 0.2))]),
    recipe("end_stop", ("upper", Even(0.1, 0.35)), None, &[("lower", Even(-0.35, -0.1))]),
    recipe("backlash", ("play", Log(0.003, 0.06)), Some(0.0), &[LOAD]),
    recipe("compliance", ("stiffness", Log(0.5, 10.0)), None, &[LOAD]),
    recipe("sensor_gain", ("gain", Log(0.85, 1.2)), Some(1.0), &[]),
    recipe("sensor_nonlinearity", ("quadratic", Either(0.1, 0.5)), Some(0.0), &[]),
    recipe("sensor_hysteresis", ("width", Log(0.003, 0.03)), Some(0.0), &[]),
    recipe("sensor_lag", ("time", Log(0.001, 0.02)), Some(0.0), &[]),
    recipe("lost_counts", ("jump", Either(0.03, 0.12)), None, &[("time", Even(4.5, 7.5))]),
    recipe("contact", ("position", Either(0.02, 0.15)), None,
        &[("stiffness", Log(0.5, 10.0)), ("from", Even(4.0, 5.5)), ("to", Even(6.0, 7.5))]),
    recipe("push", ("torque", Either(0.01, 0.05)), None, &[("from", Even(4.0, 5.0)), ("to", Even(5.2, 7.0))]),
    recipe("rate_limit", ("rate", Log(0.01, 0.1)), None, &[]),
];

/// Number of small effects beside the dominant one in a messy paddle.
const SMALL: usize = 3;
/// Relative error of the model's numbers in a messy paddle.
const OFF: f64 = 0.05;
/// Intended size of a small effect relative to the dominant one, well within [`SMALL_SHARE`].
const AIMED_SHARE: [f64; 2] = [1.3 * SMALL_SHARE[0], 0.8 * SMALL_SHARE[1]];
/// Number of bisection steps that set the size of a small effect.
const HALVINGS: usize = 14;
/// Number of draws of one effect before it is given up.
const TRIALS: usize = 200;

/// The first experiments of `paddle experiment`: one must show the hidden effect, and in the other the regulator must hold
/// the paddle.
const SHOWS: &str = "torque:multisine:0.0036,2,6";
const HOLDS: &str = "position:triangle:20,0.25,4";
/// Time at which the first experiment begins, s since power-on.
const BEGINS_S: f64 = 3.0;
/// Angle at which a torque experiment releases the paddle, rad. An experiment that reaches it before this time shows too
/// little, s.
const LET_GO_RAD: f64 = 0.48;
const LEAST_S: f64 = 1.5;
const ROWS_HZ: f64 = 1000.0;
const HORIZON_S: f64 = 0.3;
/// Control period of the firmware, s.
const PERIOD_S: f64 = 5e-5;

/// A paddle with hidden effects.
pub struct HiddenPaddle {
    /// The device that is connected to the board.
    pub device: Device,
    /// The hidden effects, the dominant effect first.
    pub effects: Vec<Effect>,
    /// True value divided by the stated value of each number of the model that has an error.
    pub off: Vec<(&'static str, f64)>,
}

impl HiddenPaddle {
    /// Draws paddle `case` of the set `seed`. The paddle has one effect: `only`, or any. If `messy`, small effects and
    /// errors of the model's numbers are added.
    ///
    /// # Errors
    /// Returns [`Failure::Board`] if no drawn parameters make an effect visible.
    pub fn draw(seed: u64, case: u64, only: Option<&str>, messy: bool) -> Result<Self, Failure> {
        let mut draw = Draw::of_case(seed, case);
        let drawn = draw.count(0, RECIPES.len() - 1);
        let recipe = match only {
            Some(name) => RECIPES.iter().find(|recipe| recipe.name == name),
            None => RECIPES.get(drawn),
        };
        let recipe = recipe.ok_or(Failure::Fault)?;
        let tried = || dominant(&mut draw, recipe).transpose();
        let (dominant, shown) = std::iter::repeat_with(tried)
            .take(TRIALS)
            .flatten()
            .next()
            .unwrap_or_else(|| {
                Err(Failure::Board(format!(
                    "case {case} of seed {seed}: no {} was drawn that the first experiment shows; take another seed",
                    recipe.name
                )))
            })?;
        let mut effects = vec![dominant];
        let mut off = Vec::new();
        if messy {
            off.extend(numbers_off(&mut draw, recipe.name));
            small(&mut draw, &shown, &mut effects)?;
        }
        let device = built(&off, &effects);
        Ok(Self {
            device,
            effects,
            off,
        })
    }

    /// The effects as arguments of `--with`.
    pub fn written(&self) -> Vec<String> {
        self.effects.iter().map(written).collect()
    }
}

/// Formats an effect as an argument of `--with`.
pub fn written(effect: &Effect) -> String {
    let numbers = effect.values.iter().enumerate();
    let numbers: Vec<_> = numbers
        .map(|(at, value)| {
            let name = effect.kind.value_name(at, effect.values.len());
            format!("{name}={value:.4e}")
        })
        .collect();
    format!("{}:{}", effect.kind.name, numbers.join(","))
}

/// Draws an effect of this kind and records the first experiment. Returns `None` if the effect is too small or too large, or
/// if the regulator cannot hold the paddle.
fn dominant(draw: &mut Draw, recipe: &Recipe) -> Result<Option<(Effect, Recording)>, Failure> {
    let effect = recipe.effect(draw, 1.0)?;
    let device = built(&[], std::slice::from_ref(&effect));
    let Some(shown) = shown(&device)? else {
        return Ok(None);
    };
    let (gap, _) = measure(&shown, &Device::nominal(&shown.model));
    let [least, most] = GAP_OVER_FLOOR.map(|floors| floors * gap.floor);
    let fits = (least..=most).contains(&gap.before) && holds(&device)?;
    Ok(fits.then_some((effect, shown)))
}

/// Draws errors of the model's numbers, except the number that the hidden effect changes.
fn numbers_off(draw: &mut Draw, hidden: &str) -> Vec<(&'static str, f64)> {
    ["inertia", "viscous", "coulomb", "gravity"]
        .into_iter()
        .map(|name| (name, 1.0 + OFF * draw.sign()))
        .filter(|(name, _)| *name != hidden)
        .collect()
}

/// Adds small effects to the dominant one, whose first experiment is `shown`.
fn small(draw: &mut Draw, shown: &Recording, effects: &mut Vec<Effect>) -> Result<(), Failure> {
    let nominal = Device::nominal(&shown.model);
    let with = |effect: &[&Effect]| {
        let mut device = nominal.clone();
        for effect in effect {
            effect.install(&mut device);
        }
        device
    };
    let dominant = effects[0].clone();
    let whole = change(shown, &with(&[&dominant]), &nominal);
    for _ in 0..TRIALS {
        if effects.len() > SMALL {
            return Ok(());
        }
        let recipe = &RECIPES[draw.count(0, RECIPES.len() - 1)];
        let wanted = whole * draw.log_uniform(AIMED_SHARE[0], AIMED_SHARE[1]);
        let mut numbers = draw.split();
        let clashes = effects
            .iter()
            .any(|effect| alike(effect.kind.name, recipe.name));
        if clashes || recipe.neutral.is_none() {
            continue;
        }
        // All steps of the bisection use the same random draw, at decreasing strength.
        let begun = numbers.seed();
        let of = |strength| recipe.effect(&mut Draw::seeded(begun), strength);
        let size = |effect: &Effect| {
            let both = with(&[&dominant, effect]);
            change(shown, &both, &with(&[&dominant]))
        };
        if size(&of(1.0)?) < wanted {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if size(&of(middle)?) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        let effect = of(high)?;
        let share = size(&effect) / whole;
        if (SMALL_SHARE[0]..=SMALL_SHARE[1]).contains(&share) {
            effects.push(effect);
        }
    }
    Err(Failure::Board(
        "no small effects were found beside the dominant one; take another seed".into(),
    ))
}

impl Recipe {
    /// Draws the parameters of the effect. `strength` 1 keeps the drawn strength; 0 makes the effect neutral.
    fn effect(&self, draw: &mut Draw, strength: f64) -> Result<Effect, Failure> {
        let (name, spread) = self.strength;
        let drawn = spread.draw(draw);
        let neutral = self.neutral.unwrap_or(drawn);
        let mut text = format!(
            "{}:{name}={}",
            self.name,
            neutral + strength * (drawn - neutral)
        );
        for (name, spread) in self.form {
            text.push_str(&format!(",{name}={}", spread.draw(draw)));
        }
        Ok(text.parse()?)
    }
}

impl Spread {
    fn draw(self, draw: &mut Draw) -> f64 {
        match self {
            Even(low, high) => draw.uniform(low, high),
            Log(low, high) => draw.log_uniform(low, high),
            Either(low, high) => draw.sign() * draw.log_uniform(low, high),
        }
    }
}

/// The nominal paddle with these errors of its numbers and these effects.
fn built(off: &[(&'static str, f64)], effects: &[Effect]) -> Device {
    let mut model = presets::nominal();
    for (name, factor) in off {
        let number = match *name {
            "inertia" => &mut model.inertia,
            "viscous" => &mut model.viscous,
            "coulomb" => &mut model.coulomb,
            _ => &mut model.gravity,
        };
        *number *= factor;
    }
    let mut device = Device::nominal(&model);
    for effect in effects {
        effect.install(&mut device);
    }
    device
}

fn setup(device: &Device, start_s: f64) -> LoopSetup {
    let mut setup = LoopSetup::firmware(device.clone(), Settings::default(), presets::motor());
    setup.paddle.start_s = start_s;
    setup
}

/// An experiment as the core of the board carries it out.
fn experiment(text: &str) -> Result<Experiment, Failure> {
    let plan: Plan = text
        .parse()
        .map_err(|error: remote::PlanError| Failure::Board(error.to_string()))?;
    let excitation = plan.excitation;
    let mut experiment = match plan.mode {
        Mode::Torque => Experiment::torque(excitation, plan.signal_s()),
        // A plan states positions in degrees.
        _ => Experiment::position(
            Excitation {
                amplitude: excitation.amplitude.to_radians(),
                ..excitation
            },
            plan.signal_s(),
        ),
    };
    experiment.log_hz = ROWS_HZ;
    Ok(experiment)
}

/// Records the first experiment on a paddle. Returns `None` if it ends too early.
fn shown(device: &Device) -> Result<Option<Recording>, Failure> {
    let setup = setup(device, BEGINS_S);
    let mut closed_loop = ClosedLoop::armed(&setup, Mode::Torque)?;
    let mut trace = experiment(SHOWS)?.run(&mut closed_loop)?;
    let kept = trace
        .encoder_rad
        .iter()
        .position(|at| at.abs() > LET_GO_RAD)
        .unwrap_or(trace.len());
    let end_s = trace.time_s.get(kept).copied().unwrap_or(f64::INFINITY);
    let stopped = trace.fault.is_some_and(|(time_s, _)| time_s < end_s);
    if stopped || (kept as f64) < LEAST_S * ROWS_HZ {
        return Ok(None);
    }
    trace.time_s.truncate(kept);
    trace.input_nm.truncate(kept);
    trace.encoder_rad.truncate(kept);
    trace.hall_rad.truncate(kept);
    trace.current_a.truncate(kept);
    let motor = presets::motor();
    let model = Model {
        delay: PERIOD_S,
        lag: motor.inductance_h / motor.resistance_ohm,
        ..presets::nominal()
    };
    let mut shown = recording("shown", HORIZON_S, model, &setup);
    shown.runs.push(trace.to_run("shown.csv", &setup));
    Ok(Some(shown))
}

/// Whether the regulator holds the paddle in a slow motion.
fn holds(device: &Device) -> Result<bool, Failure> {
    let mut closed_loop = ClosedLoop::armed(&setup(device, 0.0), Mode::Position)?;
    let trace = experiment(HOLDS)?.run(&mut closed_loop)?;
    Ok(trace.fault.is_none())
}

/// Root mean square of the difference between the predictions of two devices, rad.
fn change(shown: &Recording, one: &Device, other: &Device) -> f64 {
    let predicted = |device| {
        let (_, runs) = measure(shown, device);
        runs.into_iter().flat_map(|run| run.predicted)
    };
    let (mut squares, mut rows) = (0.0, 0.0);
    for (a, b) in predicted(one).zip(predicted(other)) {
        squares += (a - b) * (a - b);
        rows += 1.0;
    }
    f64::sqrt(squares / f64::max(rows, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use host_sim::effects::KINDS;

    #[test]
    fn every_effect_of_the_vocabulary_can_be_hidden_so_that_the_first_experiment_shows_it() {
        for kind in KINDS {
            let paddle = HiddenPaddle::draw(1, 1, Some(kind.name), false).unwrap();
            assert_eq!(paddle.effects.len(), 1, "{}", kind.name);
            let again: Effect = written(&paddle.effects[0]).parse().unwrap();
            assert_eq!(again.kind.name, kind.name);
        }
    }

    #[test]
    fn a_messy_paddle_has_three_small_effects_and_numbers_that_are_off() {
        let paddle = HiddenPaddle::draw(7, 1, None, true).unwrap();
        assert_eq!(paddle.effects.len(), 1 + SMALL);
        assert!(paddle.off.len() >= 3, "{:?}", paddle.off);
        let off = |(_, factor): &(&str, f64)| (factor - 1.0).abs() > 0.04;
        assert!(paddle.off.iter().all(off), "{:?}", paddle.off);
    }
}
