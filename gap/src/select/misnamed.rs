//! Effects that do not act as their names say.

use super::ranking::{contains, enough};
use super::round::{FITTING_ITERATIONS, POLISHING_ITERATIONS, Search};
use super::{hand, level};
use crate::candidate::{loses_all_along, push_at_most, waves_short};
use crate::fit::Fit;
use crate::fit::problem::{Part, Problem};
use host_sim::effects;

/// Share of the inertia below which a side of a transmission is none: half of the least that is typical.
const LIGHTEST_SIDE: f64 = 0.05;

impl Search<'_> {
    /// True if the last effect of a fit does not act as its name says: a hand with which something is missing and that never
    /// goes, or of which no stiffness can be told; a counter that loses of any motion; a stop that is hardly ever left; or a
    /// transmission whose spring takes longer than a prediction to come back through its damper, so that what it makes is a lag,
    /// or one side of which weighs nothing, so that its friction bends.
    pub(super) fn is_misnamed(&self, fit: &Fit) -> bool {
        let Some(last) = fit.last_term() else {
            return false;
        };
        match last.kind.name {
            "contact" if level(fit) > self.quiet() => {
                !hand::is_stiff(fit) || hand::is_lasting(self.problem, fit, FITTING_ITERATIONS)
            }
            "lost_counts" => loses_all_along(&last, &self.problem.restart_speeds()),
            "end_stop" => push_at_most(&last, self.problem.positions()),
            "backlash" | "compliance" => {
                let predictor = self.problem.predictor(&fit.hypothesis, &fit.x);
                let link = &predictor.device().mechanics.link;
                let horizon_s = self.problem.recording.horizon;
                link.is_some_and(|link| {
                    let lighter = link.load_share.min(1.0 - link.load_share);
                    link.damping > horizon_s * link.stiffness || lighter < LIGHTEST_SIDE
                })
            }
            _ => false,
        }
    }

    /// True if the last effect of a fit does no more than a special case of it that is not to be named.
    pub(super) fn is_excluded(&self, known: &Fit, fit: &Fit) -> bool {
        let Some(last) = fit.last_term() else {
            return false;
        };
        let excluded = self.given.excluded.iter();
        let special = excluded.filter(|special| contains(last.kind.name, special));
        let mut special = special.filter_map(|special| last.reduced(effects::kind(special)?));
        special.any(|special| {
            let (mut hypothesis, mut x) = fit.without(fit.hypothesis.terms.len() - 1);
            x.resize(x.len() + special.free.len(), 0.0);
            hypothesis.terms.push(special);
            let reduced = self
                .problem
                .fit(&hypothesis, x, Part::All, POLISHING_ITERATIONS);
            level(&reduced) <= enough(known, fit)
        })
    }
}

/// False if the last effect of a fit is a ripple of which less than a wave was travelled: a pull that bends does as much.
pub(super) fn repeats(problem: &Problem<'_>, fit: &Fit) -> bool {
    const WAVE_NUMBER: usize = 1;
    let ripple = fit.last_term().filter(|term| term.kind.name == "cogging");
    ripple.is_none_or(|ripple| {
        let wave_number = ripple.values[WAVE_NUMBER];
        waves_short(wave_number, problem.extremes()).is_none()
    })
}

#[cfg(test)]
mod tests {
    use super::super::Given;
    use super::super::round::on;
    use super::*;
    use crate::fit::hypothesis::{Coordinate, Scale};
    use crate::made;

    #[test]
    fn a_spring_that_comes_back_later_than_a_prediction_ends_is_a_lag() {
        let recording = made::recording(&[]);
        let is_misnamed = |damping: f64| {
            let mut soft = made::term("compliance", &[]);
            soft.values[..2].copy_from_slice(&[0.5, damping]);
            on(&recording, |search, null| {
                search.is_misnamed(&search.given(null, &soft).so_far)
            })
        };
        let latest = 0.5 * recording.horizon;
        assert!(!is_misnamed(0.5 * latest) && is_misnamed(2.0 * latest));
    }

    #[test]
    fn a_spring_with_next_to_nothing_behind_it_is_no_transmission() {
        let recording = made::recording(&[]);
        let is_misnamed = |load_share: f64| {
            let mut stiff = made::term("compliance", &[]);
            stiff.values[2] = load_share;
            on(&recording, |search, null| {
                search.is_misnamed(&search.given(null, &stiff).so_far)
            })
        };
        assert_eq!([0.02, 0.2, 0.98].map(is_misnamed), [true, false, true]);
    }

    /// Whether play is taken for a twist that is not to be named.
    fn is_twist(hidden: &str) -> bool {
        let log = |parameter, start| Coordinate {
            parameter,
            start,
            scale: Scale::Log,
        };
        let backlash = made::term("backlash", &[log(0, 0.01), log(2, 2.0), log(3, 0.005)]);
        let recording = made::recording(&[hidden]);
        on(&recording, |search, null| {
            let found = search.given(null, &backlash).so_far;
            let given = Given {
                excluded: vec!["compliance"],
                ..Given::A_GAP
            };
            let search = Search {
                given: &given,
                problem: search.problem,
                progress: search.progress,
                perfect: search.perfect,
            };
            search.is_excluded(null, &found)
        })
    }

    #[test]
    fn play_that_is_no_more_than_a_twist_is_none() {
        assert!(is_twist("compliance:stiffness=2.0,damping=0.005"));
        assert!(!is_twist("backlash:play=0.02"));
    }
}
