//! Warnings: unusual properties of a recording, and results of the diagnosis that are uncertain.

use super::confounder::Confounder;
use super::prior_tension::PriorTension;
use super::rejection::Rejection;
use super::steps::Step;
use crate::comparison::Comparison;
use crate::diagnosis::Finding;
use crate::fit::problem::Problem;
use crate::instrument::timing::TimingDoubt;
use crate::select::Selection;

/// The results of the other stages that cause warnings.
pub(super) struct Doubts<'a> {
    pub comparison: Option<&'a Comparison>,
    pub rejection: Option<&'a Rejection>,
    pub timing: Option<&'a TimingDoubt>,
    pub confounder: Option<Confounder>,
    pub steps: &'a [Step],
    pub effects: &'a [Finding],
}

/// All warnings, one line each: about the recording, about parameters that are not stated, about the fit, and about the effects.
pub(super) fn all(
    problem: &Problem<'_>,
    selection: &Selection,
    doubts: &Doubts<'_>,
) -> Vec<String> {
    let recording = problem.recording;
    let mut lines = recording.warnings();
    lines.extend(recording.unstated.iter().map(|name| {
        let assumed = recording.model.get(name).unwrap_or(0.0);
        format!("`{name}` is not stated in [model]: it is estimated with all other parameters, starting at {assumed}")
    }));
    let compared = doubts.comparison.iter();
    lines.extend(compared.filter_map(|c| c.line(&recording.units.position)));
    lines.extend(doubts.rejection.iter().map(ToString::to_string));
    lines.extend(doubts.timing.iter().map(ToString::to_string));
    let stalls = selection.fit().stalls(&problem.priors);
    lines.extend(stalls.iter().map(ToString::to_string));
    lines.extend(doubts.confounder.iter().map(ToString::to_string));
    let small = selection.rounds.iter().zip(doubts.steps);
    let small = small.filter(|(_, step)| step.is_small());
    let tensions = small.filter_map(|(round, _)| PriorTension::of(round, &problem.priors));
    lines.extend(tensions.map(|tension| tension.to_string()));
    let seen = doubts.effects.iter().filter(|effect| !effect.held_out);
    lines.extend(seen.map(|effect| {
        format!(
            "{} acts in too few windows for any to be held out: its shrink is on the data of the fit",
            effect.name
        )
    }));
    lines
}
