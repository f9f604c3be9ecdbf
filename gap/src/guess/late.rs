//! Times by which a torque or a reading comes late.

use super::Evidence;
use super::start::{linear, log, terms};
use crate::term::Term;
use host_sim::effects::Kind;

/// Shares of a time of the model that an effect which shortens it begins at, and that one unit of its coordinate is: with the
/// reach of a time it goes from none to all.
const SHORTENED: [f64; 2] = [0.5, 0.1];

/// Delays or lags of a few lengths, up to a share of the horizon, with the time as parameter 0.
pub(crate) fn later(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let least_s = s.period_s.min(0.01 * s.horizon_s).max(0.002 * s.horizon_s);
    terms(
        kind,
        None,
        [1.0, 6.0, 30.0].map(|f| vec![log(0, f * least_s)]),
    )
}

/// A time shorter than the model states, as a negative one on top of it; none if the model states none.
pub(crate) fn sooner(kind: &'static Kind, modelled_s: f64) -> Vec<Term> {
    let [start, unit] = SHORTENED.map(|share| share * modelled_s);
    let shorter = (modelled_s > 0.0).then(|| linear(0, -start, unit));
    terms(kind, shorter.map(|time| vec![time]), [])
}

/// Two equal lags in series that together take as long as each of `lags`; the parameter at `place` says that there are two.
pub(crate) fn twice(lags: &[Term], place: usize) -> Vec<Term> {
    let halved = |lag: &Term| lag.begun(&[(0, 0.5 * lag.values[0]), (place, 1.0)]);
    lags.iter().map(halved).collect()
}
