//! Frees the main parameters of the model.

use crate::effects::{self, Identification};
use crate::fit::Fit;
use crate::fit::hypothesis::PriorParameter;
use crate::fit::problem::Problem;
use crate::guess::balance::Balance;
use crate::select::Search;
use crate::term::Term;
use host_sim::effects::Quantity;
use recording::Recording;

/// Returns the model parameters that may deviate from their stated values: those with a stated tolerance, and main parameters without one.
/// The latter have the typical error of such a parameter as their standard deviation. They are not among them if the effect that replaces
/// them is `excluded`.
pub(super) fn freed(problem: &Problem<'_>, excluded: &[&str]) -> Vec<PriorParameter> {
    let mut all = problem.priors.clone();
    let effects = effects::all().filter(|effect| !excluded.contains(&effect.name()));
    for number in effects.filter_map(Identification::main_number) {
        let is_there = all.iter().any(|other| other.name == number.name);
        let value = problem.recording.model.get(number.name).unwrap_or(0.0);
        if let Some(relative) = number.usual_error
            && !is_there
            && value != 0.0
        {
            all.push(PriorParameter {
                name: number.name.to_owned(),
                value,
                relative,
                is_stated: false,
            });
        }
    }
    all
}

/// Returns the effects that estimate the main parameters again. Inertia and gain both scale the acceleration by a torque, so only one of
/// them is estimated. It is the gain if the ratio of torque to input is not stated, and the inertia otherwise.
pub(super) fn restating(recording: &Recording) -> Vec<&'static dyn Identification> {
    let is_gain_free = is_gain_free(recording);
    let is_wanted = |effect: &&dyn Identification| {
        let Some(number) = effect.main_number() else {
            return false;
        };
        let is_inertia = effect.kind().parameter(0).quantity == Quantity::Inertia;
        let is_gain = number.usual_error.is_none();
        let is_other_scale = (is_inertia && is_gain_free) || (is_gain && !is_gain_free);
        !is_other_scale && !effect.is_impossible(recording)
    };
    effects::all().filter(is_wanted).collect()
}

/// Returns the effects of [`restating`] whose parameters are not stated.
pub(super) fn unstated(recording: &Recording) -> Vec<&'static dyn Identification> {
    let mut all = restating(recording);
    all.retain(|effect| {
        let number = effect.main_number();
        number.is_some_and(|number| recording.unstated.contains(&number.name))
    });
    all
}

/// Returns true if the ratio of torque to input is not stated.
fn is_gain_free(recording: &Recording) -> bool {
    let mut gains = effects::all().filter_map(Identification::main_number);
    gains.any(|number| number.usual_error.is_none() && recording.unstated.contains(&number.name))
}

/// Returns the effects `restating` as terms, from two starts. One has the values of the nominal model, and the other has those of the
/// balance of torques.
pub(super) fn starts(
    search: &Search<'_>,
    null: &Fit,
    restating: &[&'static dyn Identification],
) -> Vec<Vec<Term>> {
    let tried = search.tried(null, &[]);
    let as_nominal = restating.iter().filter_map(|effect| {
        let found = tried
            .iter()
            .find(|candidate| candidate.effect.name() == effect.name())?;
        Some((*effect, found.starts.last()?.clone()))
    });
    let as_nominal: Vec<(&dyn Identification, Term)> = as_nominal.collect();
    let is_gain_free = is_gain_free(search.problem.recording);
    let balance = search.evidence(null, |evidence| Balance::of(evidence, is_gain_free));
    let balanced = balance.map(|balance| {
        let terms = as_nominal.iter();
        let terms = terms.map(|(effect, term)| effect.balanced(term, &balance));
        terms.collect()
    });
    let as_nominal = as_nominal.iter().map(|(_, term)| term.clone()).collect();
    core::iter::once(as_nominal).chain(balanced).collect()
}
