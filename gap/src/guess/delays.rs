//! Start values for the time of a delay or a lag.

use super::Evidence;
use super::start::{linear, log, terms};
use crate::term::Term;
use host_sim::effects::Kind;

/// Start and scale of a negative additional time, as shares of the time of the model. With the range of a time coordinate the total time
/// then varies from none to the full time.
const SHORTENED: [f64; 2] = [0.5, 0.1];

/// Delays or lags of three lengths, up to 0.3 of the horizon. Parameter 0 of the effect is the time.
pub(crate) fn longer_times(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let least_s = s.period_s.min(0.01 * s.horizon_s).max(0.002 * s.horizon_s);
    terms(
        kind,
        None,
        [1.0, 6.0, 30.0].map(|f| vec![log(0, f * least_s)]),
    )
}

/// A time shorter than that of the model, as a negative additional time. Returns none if the time of the model is zero.
pub(crate) fn shorter_time(kind: &'static Kind, modelled_s: f64) -> Vec<Term> {
    let [start, unit] = SHORTENED.map(|share| share * modelled_s);
    let shorter = (modelled_s > 0.0).then(|| linear(0, -start, unit));
    terms(kind, shorter.map(|time| vec![time]), [])
}

/// Two equal lags in series whose total time is that of each of `lags`. The parameter with index `second_lag` switches the second lag on.
pub(crate) fn two_equal_lags(lags: &[Term], second_lag: usize) -> Vec<Term> {
    let halved = |lag: &Term| lag.starting_at(&[(0, 0.5 * lag.values[0]), (second_lag, 1.0)]);
    lags.iter().map(halved).collect()
}
