//! The model's own numbers, freed.

use crate::candidate::Evidence;
use crate::candidate::regression::regress;
use crate::fit::Fit;
use crate::fit::hypothesis::{Nudge, Term};
use crate::fit::problem::Problem;
use crate::select::Search;
use recording::Recording;

/// Relative standard deviations of numbers that are stated without a tolerance, when they are freed. The trial in
/// `docs/accuracy.md` compared numbers held, freed so, and freed widely: held and wide cost twenty points of first names.
const UNTOLD: [(&str, f64); 4] = [
    ("inertia", 0.05),
    ("coulomb", 0.10),
    ("viscous", 0.30),
    ("gravity", 0.05),
];

/// The two that pull an axis back, of a rotary one and of a linear one.
pub(super) const PULLS: [&str; 2] = ["gravity", "spring"];

/// Names of the effects that say the main numbers anew: where `ratio` is not stated the gain of the torque stands for how much it
/// accelerates, as the inertia is stated then.
pub(super) fn names(recording: &Recording, is_linear: bool) -> [&'static str; 4] {
    let accelerates = if recording.unstated.contains(&"ratio") {
        "torque_gain"
    } else {
        "inertia"
    };
    [
        accelerates,
        "viscous",
        "coulomb",
        PULLS[usize::from(is_linear)],
    ]
}

/// The numbers that may move within their stated tolerances, and those without one that may move within [`UNTOLD`].
/// `ratio` without a tolerance stays: it only scales the others.
pub(super) fn freed(problem: &Problem<'_>) -> Vec<Nudge> {
    let mut all = problem.nudges.clone();
    for (name, relative) in UNTOLD {
        let is_there = all.iter().any(|number| number.name == name);
        let value = problem.recording.model.get(name).unwrap_or(0.0);
        if !is_there && value != 0.0 {
            let name = name.to_owned();
            all.push(Nudge {
                name,
                value,
                relative,
            });
        }
    }
    all
}

/// The effects that say each of the model's main numbers anew: one of the two that set how much a torque accelerates, both
/// frictions, and what pulls at the axis. Each starts twice: where the nominal model has it, and where a regression of the
/// missing torque on all of them puts it.
pub(super) fn restated(search: &Search<'_>, null: &Fit, names: &[&str]) -> Vec<Vec<Term>> {
    let tried = search.tried(null, &[]);
    let as_nominal: Vec<Term> = names
        .iter()
        .filter_map(|name| {
            let found = tried
                .iter()
                .find(|candidate| candidate.kind.name == *name)?;
            found.starts.last().cloned()
        })
        .collect();
    let regressed = search.evidence(null, |evidence| regressed(evidence, &as_nominal));
    core::iter::once(as_nominal).chain(regressed).collect()
}

/// The terms begun where one regression of the missing torque on all of them puts each.
fn regressed(evidence: &Evidence<'_>, terms: &[Term]) -> Option<Vec<Term>> {
    let nominal = &evidence.device.mechanics;
    let angle_rad = nominal.angle_rad;
    let [inertia, viscous, coulomb, sine, cosine] = regress(evidence, |moment| {
        let (sin, cos) = (angle_rad * moment.position).sin_cos();
        [
            -moment.acceleration,
            -moment.velocity,
            -moment.velocity.signum(),
            -sin,
            cos,
        ]
    })?;
    let (sin, cos) = (angle_rad * nominal.gravity_zero).sin_cos();
    let [sine, cosine] = [sine + nominal.gravity * cos, cosine + nominal.gravity * sin];
    let inertia = (nominal.inertia + inertia).max(LEAST_INERTIA * nominal.inertia);
    let begun = terms.iter().map(|term| match term.kind.name {
        "inertia" => term.begun(&[(0, inertia)]),
        "torque_gain" => term.begun(&[(0, nominal.inertia / inertia)]),
        "viscous" => term.begun(&[(0, (nominal.viscous + viscous).max(0.0))]),
        "coulomb" => term.begun(&[(0, (nominal.friction.level_nm[0] + coulomb).max(0.0))]),
        "gravity" => term.begun(&[(0, sine.hypot(cosine)), (1, cosine.atan2(sine) / angle_rad)]),
        _ => term.clone(),
    });
    Some(begun.collect())
}

/// Share of the stated inertia that a regression may come down to: noise of the acceleration draws it towards none.
const LEAST_INERTIA: f64 = 0.02;
