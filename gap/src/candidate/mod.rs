//! Where the fit of each effect starts, and in which coordinates.

mod actuation;
mod cogging;
pub(crate) mod contact;
mod friction;
mod jumps;
mod mechanics;
mod overspeed;
pub(crate) mod regression;
mod ripple;
mod sensing;
mod start;
mod stops;
mod transmission;
mod waves;

pub(crate) use actuation::further;
pub(crate) use cogging::waves_short;
pub(crate) use overspeed::loses_all_along;
#[cfg(test)]
pub(crate) use start::term;
pub(crate) use stops::{one_sided, push_at_most, untouched};

use crate::fit::hypothesis::Term;
use crate::windows::motion::{Motion, Scales};
use crate::windows::series::Series;
use host_sim::device::Device;
use host_sim::effects::{Channel, KINDS, Kind};
use rayon::prelude::*;
use recording::Model;

/// What starting values are made from.
pub(crate) struct Evidence<'a> {
    pub series: &'a [Series],
    pub motions: &'a [Motion],
    pub scales: &'a Scales,
    /// The device without the effect that is looked for.
    pub device: &'a Device,
    /// As it is stated.
    pub model: &'a Model,
    /// Of the low-pass that the position column has gone through, Hz.
    pub cutoff_hz: Option<f64>,
    /// Robust cost of each window without the effect, by running index.
    pub window_costs: &'a [f64],
}

/// One effect with the points from which it may be fitted.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub kind: &'static Kind,
    pub starts: Vec<Term>,
}

/// The same effect with more of its shape free, of a motion that goes `half_span` to either side; none if there is no more.
pub(crate) fn loosened(given: &Term, half_span: f64) -> Option<Term> {
    let shape = actuation::shape(given)
        .or_else(|| friction::shape(given))
        .or_else(|| mechanics::shape(given, half_span))
        .or_else(|| sensing::shape(given, half_span))?;
    let starts: Vec<(usize, f64)> = shape.iter().map(|c| (c.parameter, c.start)).collect();
    let mut loosened = given.begun(&starts);
    loosened.free.extend(shape);
    Some(loosened)
}

/// Every effect that the recording could show, in the order of the vocabulary.
pub(crate) fn candidates(evidence: &Evidence<'_>) -> Vec<Candidate> {
    let all = KINDS.par_iter().map(|&kind| Candidate {
        kind,
        starts: starts(kind, evidence),
    });
    all.filter(|candidate| !candidate.starts.is_empty())
        .collect()
}

/// Points from which the fit of an effect may begin.
fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    match kind.channel {
        Channel::Actuation => actuation::starts(kind, e),
        Channel::Friction => friction::starts(kind, e),
        Channel::Mechanics => mechanics::starts(kind, e),
        Channel::Sensing => sensing::starts(kind, e),
        Channel::Surroundings => contact::starts(kind, e),
    }
}
