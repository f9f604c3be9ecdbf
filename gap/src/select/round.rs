//! One more effect on top of what is known.

use super::evolution::evolved;
use super::finals::{best_of, join_all};
use super::hand;
use super::place::{Place, bounces, earns_its_place};
use super::ranking::{contains, enough, is_as_likely, is_far_likelier, ranked};
use super::rival::{Rival, extended};
use super::{Given, MOST_LEFT_EXPLAINED, QUIET_EXCESS, is_quiet, level};
use crate::candidate::{
    loosened, loses_all_along, one_sided, push_at_most, untouched, waves_short,
};
use crate::fit::Fit;
use crate::fit::hypothesis::{Hypothesis, Term};
use crate::fit::problem::{Part, Problem};
use crate::floor::Perfect;
use crate::stage::Stage;
use host_sim::effects;

/// Iterations for all finalists, for those that are near the best then, and more for the one that is named.
pub(super) const SHORT_ITERATIONS: usize = 3;
pub(super) const FITTING_ITERATIONS: usize = 8;
const POLISHING_ITERATIONS: usize = 15;
/// Spread, in scales, of a search around the winner where slopes lead nowhere.
const NARROWLY: f64 = 0.15;
/// Share of the inertia below which a side of a transmission is none: half of the least that is typical.
const LIGHTEST_SIDE: f64 = 0.05;
/// Share of the excess that the model's own numbers alone must make up for to be taken from beside an effect.
const LEAST_MADE_UP: f64 = 0.5;

/// One effect on top of what was known, with what stood beside it.
#[derive(Clone, Debug)]
pub(crate) struct Round {
    /// What was known without it.
    pub known: Fit,
    /// All finalists, the winner first, the others by what they leave.
    pub rivals: Vec<Rival>,
    /// Every effect as screening left it.
    pub screened: Vec<Rival>,
    /// Whether the winner is better than what was known.
    pub place: Place,
    /// The model with the effects up to this one.
    pub so_far: Fit,
}

impl Round {
    /// True if a fit leaves less than its winner does.
    pub(super) fn leaves_more_than(&self, fit: &Fit) -> bool {
        level(fit) < level(&self.rivals[0].fit)
    }

    /// The same on top of what is `known` without one of the effects before it.
    pub(super) fn without(&self, problem: &Problem<'_>, place: usize, known: Fit) -> Self {
        let (hypothesis, x) = self.so_far.without(place);
        let fit = problem.fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Self {
            known,
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: self.rivals[0].name,
                fit,
            }],
            screened: Vec::new(),
            ..*self
        }
    }
}

/// What all rounds share.
pub(crate) struct Search<'a> {
    pub problem: &'a Problem<'a>,
    pub given: &'a Given<'a>,
    /// Told of each stage.
    pub progress: fn(Stage),
    pub perfect: Perfect,
}

impl Search<'_> {
    /// Tries every effect on top of `known`. Of effects with many starts, what `hints` found is the only one. None if none
    /// closes a `promised` share of the excess in screening.
    pub(crate) fn round(&self, known: &Fit, hints: &[Rival], promised: f64) -> Option<Round> {
        let chosen = self.screening_windows(known);
        let screened = self.screened(known, &chosen, hints);
        let Fit { hypothesis, x, .. } = known;
        let there = self.problem.costs(hypothesis, x, Part::Chosen(&chosen));
        let enough = there.level() - promised * (there.level() - self.perfect.level);
        if promised > 0.0 && screened.iter().all(|rival| level(&rival.fit) > enough) {
            return None;
        }
        self.round_of(known, screened, None)
    }

    /// An effect that is known to be there, at a known size.
    pub(crate) fn given(&self, null: &Fit, term: &Term) -> Round {
        let (hypothesis, x) = extended(null, [term]);
        let fit = self
            .problem
            .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
        Round {
            known: null.clone(),
            so_far: fit.clone(),
            rivals: vec![Rival {
                name: term.kind.name,
                fit,
            }],
            screened: Vec::new(),
            place: Place::given(term.is_event()),
        }
    }

    /// The round of what screening left on top of `known`, and of what was `found` there otherwise.
    pub(super) fn round_of(
        &self,
        known: &Fit,
        screened: Vec<Rival>,
        found: Option<Rival>,
    ) -> Option<Round> {
        let rivals = self.finals(screened.clone(), known, found);
        self.judged(known, screened, rivals)
    }

    /// One of two stops where the other gains next to nothing: beyond the motion any place would do.
    fn one_stop(&self, known: &Fit, both: &Fit) -> Option<Fit> {
        let (stops, others) = both.hypothesis.terms.split_last()?;
        let (before, own) = both.x.split_at(both.x.len() - stops.free.len());
        let travel = self.problem.recording.model.travel;
        let untouched = untouched(travel, self.problem.extremes());
        let single = one_sided(stops, own, untouched).into_iter();
        let fits = single.map(|(stop, own)| {
            let terms = [others, &[stop]].concat();
            let x = [before, &own].concat();
            let hypothesis = Hypothesis { terms };
            self.problem
                .fit(&hypothesis, x, Part::All, SHORT_ITERATIONS)
        });
        let enough = enough(known, both);
        let fits = fits.filter(|fit| level(fit) <= enough);
        fits.min_by(|a, b| level(a).total_cmp(&level(b)))
    }

    /// A fit with what its last effect was given freed, where it is not at its floor and leaves less then by more than a number
    /// is worth.
    fn loosened(&self, known: &Fit, given: &Fit) -> Option<Fit> {
        if self.problem.is_at_floor(given) {
            return None;
        }
        let fit = self.with_more_free(given)?;
        (level(given) > enough(known, &fit))
            .then(|| self.problem.polished(&fit, POLISHING_ITERATIONS))
    }

    /// A fit with what its last effect was given freed, if anything was.
    fn with_more_free(&self, given: &Fit) -> Option<Fit> {
        let [low, high] = self.problem.extremes();
        let half_span = 0.5 * (high - low);
        let (hypothesis, x) = given.loosened(|term| loosened(term, half_span))?;
        let part = Part::All;
        Some(self.problem.fit(&hypothesis, x, part, POLISHING_ITERATIONS))
    }

    /// Level up to which nothing is missing.
    pub(super) fn quiet(&self) -> f64 {
        self.perfect.level + QUIET_EXCESS
    }

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
    fn is_excluded(&self, known: &Fit, fit: &Fit) -> bool {
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

    /// The rivals, what the best of them contains carried on to the end where it leaves little enough for that: with fewer
    /// numbers it has fewer ways past a kink.
    fn with_specials_polished(&self, known: &Fit, mut rivals: Vec<Rival>) -> Vec<Rival> {
        let Some(best) = best_of(&rivals).cloned() else {
            return rivals;
        };
        let most = 0.5 * (level(known) + level(&best.fit));
        for rival in &mut rivals {
            let is_open = level(&rival.fit) > self.quiet() || is_far_likelier(&best, rival);
            if contains(best.name, rival.name) && is_open && level(&rival.fit) <= most {
                rival.fit = self.problem.polished(&rival.fit, POLISHING_ITERATIONS);
                // What it is to give way to may do no more than a shape that it was not free to take.
                if is_far_likelier(&best, rival)
                    && let Some(fit) = self.with_more_free(&rival.fit)
                    && let freed = (Rival { fit, ..*rival })
                    && !is_far_likelier(&best, &freed)
                {
                    *rival = freed;
                }
            }
        }
        rivals
    }

    /// The rivals, another weight hanging where it is stated to hang if it does as well there.
    fn hung_as_stated(&self, known: &Fit, mut rivals: Vec<Rival>) -> Vec<Rival> {
        const ZERO: usize = 1;
        let stated = self.problem.recording.model.gravity_zero;
        for rival in rivals.iter_mut().filter(|r| r.name == "gravity") {
            let Some(mut held) = rival.with_held(ZERO, stated) else {
                continue;
            };
            let Fit { hypothesis, x, .. } = held.fit;
            held.fit = self
                .problem
                .fit(&hypothesis, x, Part::All, FITTING_ITERATIONS);
            if let Some(mut both) = ranked(vec![rival.clone(), held], known, self.quiet()) {
                *rival = both.swap_remove(0);
            }
        }
        rivals
    }

    /// The rivals in their order.
    fn ordered(&self, known: &Fit, rivals: Vec<Rival>) -> Option<Vec<Rival>> {
        let mut rivals = ranked(rivals, known, self.quiet())?;
        let best = level(&rivals[0].fit);
        let short_by = |share: f64| best + share * (level(known) - best);
        let halfway = short_by(0.5);
        // Of a ripple that was not seen to repeat a pull may be all; where it leaves nothing, that must leave next to nothing.
        let pulls = (!repeats(self.problem, &rivals[0].fit)).then(|| {
            if best > self.quiet() {
                halfway
            } else {
                short_by(MOST_LEFT_EXPLAINED)
            }
        });
        let special = rivals.iter().position(|rival| {
            // What needs a moment of its own is none where the same thing at all times leaves nothing.
            let leaves_nothing = || {
                level(&rival.fit) <= halfway
                    && is_as_likely(rival, &rivals[0])
                    && is_quiet(&rival.fit, &Perfect::of(self.problem, &rival.fit).bounded())
            };
            contains(rivals[0].name, rival.name)
                && (pulls.is_some_and(|most| level(&rival.fit) <= most) || leaves_nothing())
        });
        if let Some(special) = special {
            let special = rivals.remove(special);
            rivals.insert(0, special);
        }
        Some(rivals)
    }

    /// What was known without the winner of a round, from where a rival leaves the model's own numbers, if those alone make up
    /// for much: the way there may lead through worse.
    pub(crate) fn nominal_beside(&self, round: &Round) -> Option<Fit> {
        let known = &round.known;
        let excess = level(known) - self.perfect.level;
        if excess <= QUIET_EXCESS {
            return None;
        }
        let below = level(known) - LEAST_MADE_UP * excess;
        let starts = round.rivals.iter();
        let starts = starts.map(|rival| rival.fit.x[..known.x.len()].to_vec());
        self.problem.fit_from_lowest(
            &known.hypothesis,
            starts.collect(),
            below,
            FITTING_ITERATIONS,
        )
    }

    /// A round with its winner begun anew from far around, if that leads to less.
    pub(crate) fn begun_afar(&self, round: &Round) -> Option<Round> {
        let Rival { name, fit: winner } = &round.rivals[0];
        let of = if self.has_two_masses(winner) {
            winner
        } else {
            &round.known
        };
        let chosen = self.screening_windows(of);
        let fit = self
            .problem
            .begun_afar(winner, Part::Chosen(&chosen), FITTING_ITERATIONS);
        let fit = fit.filter(|fit| round.leaves_more_than(fit))?;
        let mut rivals = round.rivals.clone();
        rivals[0] = Rival { name, fit };
        self.judged(&round.known, round.screened.clone(), rivals)
    }

    /// The rivals in their order, the best one polished and judged, after what is related to it.
    pub(super) fn judged(
        &self,
        known: &Fit,
        screened: Vec<Rival>,
        rivals: Vec<Rival>,
    ) -> Option<Round> {
        (self.progress)(Stage::Judging);
        let best = best_of(&rivals)?.name;
        let rivals = self.with_specials_polished(known, rivals);
        let rivals = self.hung_as_stated(known, rivals);
        let mut rivals = self.ordered(known, rivals)?;
        let Rival { name, fit: winner } = &mut rivals[0];
        if bounces(name) {
            let costs = |x: &[f64]| self.problem.costs(&winner.hypothesis, x, Part::All);
            (_, winner.x) = evolved(winner.x.clone(), NARROWLY, |x| costs(x).level());
        }
        if *name == "contact" {
            *winner = hand::found(
                self.problem,
                &self.perfect,
                known,
                winner,
                FITTING_ITERATIONS,
            );
        }
        if self.is_misnamed(winner) || self.is_excluded(known, winner) {
            rivals.remove(0);
            return self.judged(known, screened, rivals);
        }
        *winner = self.problem.polished(winner, POLISHING_ITERATIONS);
        if let Some(loosened) = self.loosened(known, winner) {
            *winner = loosened;
        }
        if *name == "end_stop"
            && let Some(single) = self.one_stop(known, winner)
        {
            *winner = single;
        }
        let first = *name;
        if first != best {
            let related = self.related(&rivals[0], &screened);
            join_all(&mut rivals, related);
            rivals = self.hung_as_stated(known, rivals);
            rivals = self.ordered(known, rivals)?;
        }
        let Rival { name, fit: winner } = &mut rivals[0];
        if *name != first {
            *winner = self.problem.polished(winner, POLISHING_ITERATIONS);
        }
        let place = earns_its_place(self.problem, &self.perfect, known, &rivals[0]);
        Some(Round {
            known: known.clone(),
            so_far: rivals[0].fit.clone(),
            rivals,
            screened,
            place,
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

/// What a search for one more effect on top of a bare nominal model comes to.
#[cfg(test)]
pub(super) fn on<T>(
    recording: &recording::Recording,
    look: impl FnOnce(&Search<'_>, &Fit) -> T,
) -> T {
    let problem = crate::made::problem(recording);
    let bare = Hypothesis { terms: Vec::new() };
    let null = problem.fit(&bare, Vec::new(), Part::All, 0);
    let search = Search {
        problem: &problem,
        given: &Given::A_GAP,
        progress: |_| {},
        perfect: Perfect::of(&problem, &null).bounded(),
    };
    look(&search, &null)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::{Coordinate, Scale};
    use crate::made;
    use core::f64::consts::PI;

    /// How suddenly static friction falls, and how slowly the last of it, once that is freed, where it was given to fall with
    /// an exponent of 1 and no tail.
    fn freed([exponent, tail]: [f64; 2]) -> Option<[f64; 2]> {
        let hidden =
            format!("stribeck:static_ratio=2.5,velocity=1.0,exponent={exponent},tail={tail}");
        let free = [(0, 2.0), (1, 0.5)].map(|(parameter, start)| Coordinate {
            parameter,
            start,
            scale: Scale::Log,
        });
        let mut stribeck = made::term("stribeck", &free);
        stribeck.values[2] = 1.0;
        on(&made::recording(&[&hidden]), |search, null| {
            let given = search.given(null, &stribeck).so_far;
            let freed = search.loosened(null, &given)?;
            let [_, _, exponent, tail] = freed.last_term()?.values[..] else {
                return None;
            };
            Some([exponent, tail])
        })
    }

    #[test]
    fn how_a_spring_hardens_is_freed_where_it_does() {
        let hardening = |hidden: f64| {
            let spring = format!("spring:stiffness=0.06,zero=0,hardening={hidden}");
            let free = Coordinate {
                parameter: 0,
                start: 0.05,
                scale: Scale::Log,
            };
            on(&made::recording(&[&spring]), |search, null| {
                let term = made::term("spring", &[free]);
                let given = search.given(null, &term).so_far;
                Some(search.loosened(null, &given)?.last_term()?.values[2])
            })
        };
        assert_eq!(hardening(0.0), None);
        let found = hardening(2.0).unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.02, "{found}");
    }

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

    #[test]
    fn around_which_place_a_sensor_bends_is_freed_where_it_is_another() {
        const BENT: &str = "sensor_nonlinearity:quadratic=0.3,cubic=1.5,middle=0.08";
        // Two places make one curve: its slope at zero tells of either.
        let steeper =
            |[square, cube, middle]: [f64; 3]| middle * (3.0 * cube * middle - 2.0 * square);
        let free = [0, 1].map(|parameter| Coordinate {
            parameter,
            start: 0.0,
            scale: Scale::Linear(1.0),
        });
        let found = on(&made::recording(&[BENT]), |search, null| {
            let around_zero = made::term("sensor_nonlinearity", &free);
            let given = search.given(null, &around_zero).so_far;
            let freed = search.loosened(null, &given)?.last_term()?;
            Some(steeper([0, 1, 6].map(|place| freed.values[place])))
        });
        let hidden = steeper([0.3, 1.5, 0.08]);
        assert!((found.unwrap() / hidden - 1.0).abs() < 0.1, "{found:?}");
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

    #[test]
    fn a_pull_that_bends_is_no_ripple_of_which_less_than_a_wave_was_travelled() {
        let free = |parameter, start| Coordinate {
            parameter,
            start,
            scale: Scale::Linear(0.2 * start),
        };
        let first = |amplitude: f64, wave_number: f64| {
            let hidden =
                format!("cogging:amplitude={amplitude},wave_number={wave_number},phase={PI}");
            on(&made::recording(&[&hidden]), |search, null| {
                let ripple = Term {
                    values: vec![amplitude, wave_number, PI, 0.0, 0.0],
                    ..made::term("cogging", &[free(0, amplitude), free(1, wave_number)])
                };
                let spring = made::term("spring", &[free(0, 0.05)]);
                let rivals = [ripple, spring].into_iter();
                let rivals = rivals.flat_map(|term| search.given(null, &term).rivals);
                let ordered = search.ordered(null, rivals.collect()).unwrap();
                ordered[0].name
            })
        };
        assert_eq!(first(0.25, 0.12), "spring");
        // What bends so much is no pull, whatever else it may be.
        assert_eq!(first(0.2, 0.15), "cogging");
        assert_eq!(first(0.02, 20.0), "cogging");
    }

    #[test]
    fn how_suddenly_static_friction_falls_is_freed_where_it_was_given_wrongly() {
        assert_eq!(freed([1.0, 0.0]), None);
        for hidden in [[2.0, 0.0], [2.0, 1.0]] {
            let freed = freed(hidden).unwrap();
            for (found, there) in freed.iter().zip(hidden) {
                assert!((found - there).abs() < 0.2, "{freed:?} for {hidden:?}");
            }
        }
    }
}
