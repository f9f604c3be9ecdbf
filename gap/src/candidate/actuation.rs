//! What lies between the input and the torque.

use super::Evidence;
use super::cogging;
use super::regression::regress;
use super::start::{geometric, guessed, linear, log, term, terms};
use crate::fit::hypothesis::{Coordinate, Term};
use crate::windows::motion::quantile;
use host_sim::effects::Kind;

/// Widths of a gate over the input's root mean square, and how many of them.
const GATES: [f64; 2] = [0.03, 1.5];
const GATE_STARTS: usize = 40;
/// Which of a dead band's numbers says that it is before the limit.
const BEFORE_LIMIT: usize = 2;
/// Which says how far it lies off zero, and how far it well may.
const SKEW: usize = 3;
const SKEWED: f64 = 0.5;
/// Which of a lag's numbers says that it is one by itself, and which that there are two of it.
const APART: usize = 1;
const TWICE: usize = 2;
/// Knee from which that of a clipping that sets in little by little is looked for.
const KNEE: f64 = 0.5;
/// Which of its numbers is the speed at which nothing acts any more, and that over the fastest: what is as fast for all but a
/// few samples.
const NO_LOAD_SPEED: usize = 2;
const NO_LOAD: [f64; 2] = [1.2, 3.0];
const FASTEST: f64 = 0.99;
/// Shares of a time of the model that an effect which shortens it begins at, and that one unit of its coordinate is: with the
/// reach of a time it goes from none to all.
const SHORTENED: [f64; 2] = [0.5, 0.1];
/// Shares of the way from the model's limit to the largest input at which another limit is looked for, and how many of the
/// largest inputs a limit is none.
const RAISED: [f64; 2] = [0.3, 0.9];
const OUT_OF_REACH: f64 = 10.0;

pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    match kind.name {
        "torque_gain" => {
            let as_known = e.device.drive.ratio / e.model.ratio;
            let guess = regress(e, |m| [m.drive_nm]);
            let guess = guess.map(|[g]| vec![log(0, as_known * (1.0 + g).max(0.05))]);
            terms(kind, guess, [vec![log(0, as_known)]])
        }
        "torque_offset" => {
            let guess = regress(e, |_| [1.0]).map(|[t]| vec![guessed(0, t, 0.2 * s.torque)]);
            let offset = |f: f64| vec![linear(0, f * s.friction, 0.2 * s.torque)];
            terms(kind, guess, [0.3, -0.3].map(offset))
        }
        "deadband" => {
            let missing = [0.05, 0.2, 0.6].map(|f| vec![log(0, f * s.input)]);
            let missing = terms(kind, None, missing);
            let before_limit = missing.iter().filter(|_| is_limited(e));
            let before_limit = before_limit.map(|start| start.begun(&[(BEFORE_LIMIT, 1.0)]));
            let before_limit: Vec<Term> = before_limit.collect();
            let skewed = [0.2, 0.6].map(|f| vec![log(0, f * s.input), linear(SKEW, 0.0, SKEWED)]);
            let skewed = terms(kind, None, skewed);
            [missing, skewed, before_limit, gates(kind, e)].concat()
        }
        "saturation" => {
            let inputs = e.series.iter().flat_map(|s| &s.input);
            // What the drive clips as it is cannot show where else it does.
            let inputs: Vec<f64> = inputs.map(|u| e.device.drive.taken(*u)).collect();
            // Where it would clip the largest, a few, many.
            let limits = [1.0, 0.99, 0.95, 0.8, 0.5].map(|share| quantile(&inputs, share));
            let limits = limits.map(|limit| log(0, 0.9 * limit.max(0.1 * s.input)));
            let clipped = limits.map(|limit| term(kind, vec![limit], &[(1, 0.0)]));
            let rounded = limits.map(|limit| term(kind, vec![limit, log(1, KNEE)], &[]));
            let falling = falling(kind, e, &limits);
            let lower = clipped.into_iter().chain(rounded).chain(falling);
            lower.chain(raised(kind, e)).collect()
        }
        "lag" => [lags(kind, e), sooner(kind, e.model.lag)].concat(),
        "delay" => [late(kind, e), sooner(kind, e.model.delay)].concat(),
        "cogging" => cogging::starts(kind, e),
        _ => Vec::new(),
    }
}

/// Limits of a voltage, which fall with speed.
fn falling(kind: &'static Kind, e: &Evidence<'_>, limits: &[Coordinate]) -> Vec<Term> {
    let speeds = e.motions.iter().flat_map(|m| &m.velocity).map(|v| v.abs());
    let fastest = quantile(&speeds.collect::<Vec<f64>>(), FASTEST);
    let no_load = NO_LOAD.map(|f| log(NO_LOAD_SPEED, f * fastest));
    let falling = limits
        .iter()
        .flat_map(|limit| no_load.map(|no_load| term(kind, vec![*limit, no_load], &[(1, 0.0)])));
    falling.collect()
}

/// Limits beyond the model's, where that clips what was told.
fn raised(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let largest = e.series.iter().map(|series| series.largest_input);
    let largest = largest.fold(0.0, f64::max);
    let limit = e.device.drive.taken(largest);
    let raised = RAISED.map(|share| limit + share * (largest - limit));
    let raised = [OUT_OF_REACH * largest].into_iter().chain(raised);
    raised
        .filter(|_| is_limited(e))
        .map(|limit| term(kind, vec![log(0, limit)], &[(1, 0.0)]))
        .collect()
}

/// What takes less than the time that the model says, if it says any.
fn sooner(kind: &'static Kind, modelled_s: f64) -> Vec<Term> {
    let [start, unit] = SHORTENED.map(|share| share * modelled_s);
    let shorter = (modelled_s > 0.0).then(|| linear(0, -start, unit));
    terms(kind, shorter.map(|time| vec![time]), [])
}

/// What comes later than it should, here or at the sensor.
pub(super) fn late(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let least_s = s.period_s.min(0.01 * s.horizon_s).max(0.002 * s.horizon_s);
    terms(
        kind,
        None,
        [1.0, 6.0, 30.0].map(|f| vec![log(0, f * least_s)]),
    )
}

/// True if the drive does not take all of the input.
fn is_limited(e: &Evidence<'_>) -> bool {
    let mut inputs = e.series.iter().map(|series| series.largest_input);
    inputs.any(|input| e.device.drive.taken(input) < input)
}

/// A longer lag than the model's, or another one behind that, or both.
fn lags(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let longer = late(kind, e);
    let has_one = e.device.drive.lag_s > 0.0;
    let behind: Vec<Term> = longer.iter().filter(|_| has_one).map(further).collect();
    let both = twice(&longer, TWICE);
    [longer, behind, both].concat()
}

/// Two such lags that together take as long as each by itself; the number at `place` says that they are two.
pub(super) fn twice(lags: &[Term], place: usize) -> Vec<Term> {
    let halved = |lag: &Term| lag.begun(&[(0, 0.5 * lag.values[0]), (place, 1.0)]);
    lags.iter().map(halved).collect()
}

/// The same lag as another one behind the model's.
pub(crate) fn further(lag: &Term) -> Term {
    lag.begun(&[(APART, 1.0)])
}

/// How far a dead band lies off zero, where that was given.
pub(super) fn shape(given: &Term) -> Option<Vec<Coordinate>> {
    let is_even = given.kind.name == "deadband" && !given.is_free(SKEW);
    is_even.then(|| vec![linear(SKEW, 0.0, SKEWED)])
}

/// Dead bands that let all through beyond them: each sample comes through at a width of its own.
fn gates(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let widths = geometric(GATES, GATE_STARTS).map(|f| f * e.scales.input);
    widths
        .map(|width| term(kind, vec![log(0, width)], &[(1, 1.0)]))
        .collect()
}
