//! Which effects earn their place.

mod beside;
mod evolution;
mod field;
mod finals;
mod freedom;
mod hand;
mod kin;
mod misnamed;
mod pair;
mod place;
mod precedence;
mod proposed;
mod ranking;
mod refined;
mod rival;
mod round;
mod scan;
mod screening;

use crate::effects::{self, Landscape};
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::{FLOOR_DOUBT, Perfect};
use crate::stage::Stage;
use crate::term::Term;
pub(crate) use place::Place;
use ranking::is_far_likelier;
pub(crate) use ranking::{inseparable, luck, others, ties};
pub(crate) use rival::Rival;
pub(crate) use round::Search;
pub(crate) use round::{Measured, Round};

/// Robust excess per window up to which nothing is missing: the noise is known to some 15 %.
const QUIET_EXCESS: f64 = 0.12;
/// And this many standard errors of what a perfect model leaves.
const QUIET_ERRORS: f64 = 2.0;
/// Robust cost by which a window may exceed the worst of a perfect model.
const QUIET_WINDOW: f64 = 3.0;
/// Robust excess per window, beyond as many standard errors, that a gap near its floor does not hide: a floor that a restart or
/// two make is none for the others. Of 86 recordings with nothing wrong but a dry friction of another form it was 1.3 at most.
const PLAIN_EXCESS: f64 = 2.0;
/// Gap over floor up to which nothing that can be named is missing: near stick and slip a few restarts may decide either.
pub(crate) const QUIET_GAP: f64 = 2.0;
/// Gap over floor beyond which something is, be it in a restart or two: of 90 recordings with nothing wrong the largest was
/// 1.8.
pub(crate) const LOUD_GAP: f64 = 3.0;
/// The same of a run by itself: of 92 recordings with nothing wrong but a dry friction of another form it was 2.9 in two, and
/// beyond that in two that such a friction explains.
const LOUD_RUN: f64 = 5.0;
const NULL_ITERATIONS: usize = 10;
/// Effects that are found at most.
const MOST_EFFECTS: usize = 3;
/// Share of the robust excess that named effects may leave; a wrong name for a foreign cause leaves more.
pub(crate) const MOST_LEFT: f64 = 0.7;
/// Share of it that two effects may leave for a third to be looked for.
const HOPELESS: f64 = 0.75;
/// Share of the excess that may be left where nothing else of its size is missing: as much as a further effect must close
/// to earn its place. Several wrong names together may bring the gap of a foreign cause near the floor, not this.
pub(crate) const MOST_LEFT_EXPLAINED: f64 = 0.1;
/// Effects that may do together what a ripple that was not seen to repeat does.
const MOST_PULLS: usize = 2;
/// Share of the excess that the better of two effects closes by itself at least, or robust cost that it saves, as for 18 % of
/// the gap, in each window or of the whole: far above the floor a share is more than one of two may close.
const LEAST_GAIN_ALONE: f64 = 0.1;
const LEAST_SAVED_ALONE: f64 = 0.4;
/// Share of the excess that a further effect must close in screening to be fitted to all windows: as much as it must then, and
/// where the gap is at its floor, so that it can close nothing of that, much more.
const LEAST_PROMISED: f64 = 0.1;
const LEAST_PROMISED_AT_FLOOR: f64 = 0.5;
/// Share of the excess that one effect may leave for its fit to begin anew from far around before a second is looked for.
const MOST_LEFT_BY_ONE: f64 = 0.9;

/// What is known before the search.
#[derive(Clone)]
pub(crate) struct Given<'a> {
    /// True if there is more than noise and restarts leave.
    pub is_gap: bool,
    /// Effects that are not there, or not to be tried.
    pub excluded: Vec<&'a str>,
    /// An effect that was measured otherwise: it is tried at this size alone.
    pub measured: Option<Term>,
    /// True if that one is there for sure.
    pub certain: bool,
}

#[cfg(test)]
impl Given<'_> {
    /// That there is a gap.
    pub(crate) const A_GAP: Self = Self {
        is_gap: true,
        excluded: Vec::new(),
        measured: None,
        certain: false,
    };
}

/// The outcome: the null, and a round for each effect.
#[derive(Clone, Debug)]
pub(crate) struct Selection {
    pub null: Fit,
    /// True if the null leaves no more than it would if it were right, or no more of the gap than noise and restarts do: nothing is
    /// missing that could be seen.
    pub quiet: bool,
    /// True if it leaves so much more in every window or in one run that something is, though the gap is near its floor.
    pub plain: bool,
    /// True if the first round was given.
    pub given: bool,
    /// What the null would cost if it were right, as far as it can stand in for the device.
    pub perfect: Perfect,
    pub rounds: Vec<Round>,
    /// The round that found nothing more.
    pub last: Option<Round>,
}

impl Selection {
    /// The fit with all effects.
    pub(crate) fn fit(&self) -> &Fit {
        self.rounds.last().map_or(&self.null, |round| &round.so_far)
    }

    /// The name of a ripple among the effects of which less than a wave was travelled, if there is one.
    fn unrepeated(&self, problem: &Problem<'_>) -> Option<&'static str> {
        let mut winners = self.rounds.iter().map(|round| &round.rivals[0]);
        let unrepeated = winners.find(|winner| !misnamed::repeats(problem, &winner.fit));
        unrepeated.map(|winner| winner.name)
    }

    /// True if its effects were measured beside each other at an error scale of their own: what they leave is no measure of whether
    /// there is a gap.
    pub(crate) fn is_measured(&self) -> bool {
        self.rounds.iter().any(|round| round.measured.is_some())
    }

    /// True if no effect is among those found of which data could be held out.
    pub(crate) fn shows_in_few(&self) -> bool {
        self.rounds.iter().all(|round| round.place.by_few)
    }

    /// Terms of the null: numbers of the model that are not stated, and estimated with every hypothesis.
    pub(crate) fn base(&self) -> usize {
        self.null.hypothesis.terms.len()
    }

    /// Effects that were given: they are there whatever they close.
    pub(crate) fn kept(&self) -> usize {
        usize::from(self.given)
    }

    /// Takes an effect that has earned its place; one that has not is the last that was looked for.
    fn add(&mut self, round: Round) {
        if round.place.earned {
            self.rounds.push(round);
        } else {
            self.last = Some(round);
        }
    }

    /// The same with some rounds more.
    fn with(&self, rounds: Vec<Round>) -> Self {
        let mut more = self.clone();
        for round in rounds {
            more.add(round);
        }
        more
    }

    /// True if one more effect may be found on top of those there are.
    fn goes_on(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let hopeless = !self.given && self.is_hopeless(fit);
        let possible = self.last.is_none() && !hopeless;
        possible
            && match self.rounds.len() {
                // The second of two may be small beside the first.
                1 => true,
                2..MOST_EFFECTS => {
                    !self.leaves_little(fit) || problem.gap_over_floor(fit) > LOUD_GAP
                }
                _ => false,
            }
    }

    /// Takes back the effects from one on; the first of them found nothing more, then.
    pub(crate) fn withdraw(&mut self, from: usize) {
        self.last = self.rounds.drain(from..).next();
    }

    /// Takes back the last effect, without which the others are as they were fitted then.
    pub(crate) fn withdraw_last(&mut self, others: Fit) {
        self.last = self.rounds.pop();
        if let Some(round) = self.rounds.last_mut() {
            round.so_far = others;
        }
    }

    /// Takes back one effect; those after it are fitted anew without it.
    pub(crate) fn withdraw_one(&mut self, problem: &Problem<'_>, place: usize) {
        let base = self.base();
        let mut later = self.rounds.split_off(place).into_iter();
        self.last = later.next();
        self.rounds.extend(later);
        let mut known = match place.checked_sub(1) {
            Some(before) => self.rounds[before].so_far.clone(),
            None => self.null.clone(),
        };
        for round in &mut self.rounds[place..] {
            *round = round.without(problem, base + place, known);
            known = round.so_far.clone();
        }
    }

    /// Share of the null's robust excess that a fit leaves; none where there is no excess but in a window or two.
    pub(crate) fn left(&self, fit: &Fit) -> f64 {
        let excess = level(&self.null) - self.perfect.level;
        if excess <= QUIET_EXCESS {
            return 0.0;
        }
        ((level(fit) - self.perfect.level) / excess).max(0.0)
    }

    /// The same beyond what the fit would leave if it were right, unless that is more than it does leave.
    pub(crate) fn missing(&self, problem: &Problem<'_>, fit: &Fit) -> f64 {
        let own = Perfect::of(problem, fit).level;
        let excess = level(&self.null) - own;
        if own > level(fit) || excess <= QUIET_EXCESS {
            return self.left(fit);
        }
        (level(fit) - own) / excess
    }

    /// True if the effects leave what wrong names do, be it of the gap, and do not spare the model's own numbers a move that is
    /// not likely.
    pub(crate) fn leaves_most(&self, problem: &Problem<'_>) -> bool {
        let fit = self.fit();
        let spares = fit.is_likely() && !self.null.is_likely();
        self.left(fit) > MOST_LEFT && !spares && !problem.is_at_floor(fit)
    }

    /// True if the model's own numbers, moved no farther than is likely, leave no more than so many times what noise and
    /// restarts do.
    pub(crate) fn null_leaves_at_most(&self, floors: f64, problem: &Problem<'_>) -> bool {
        self.null.is_likely() && problem.gap_over_floor(&self.null) <= floors
    }

    /// True if a fit leaves so much that nothing more can bring a name.
    fn is_hopeless(&self, fit: &Fit) -> bool {
        self.left(fit) > HOPELESS
    }

    /// True if a fit leaves less than a further effect must close, and does not bend the model's own numbers for it.
    fn leaves_little(&self, fit: &Fit) -> bool {
        fit.is_likely() && self.left(fit) <= MOST_LEFT_EXPLAINED
    }

    /// True if it leaves no more than it would if it were right, where that is little beside what the null leaves, or as much
    /// of the gap as is foretold: near stick and slip even a right model leaves more than little. Or if little is left of the
    /// excess, and nothing of the gap.
    pub(crate) fn suffices(&self, problem: &Problem<'_>, fit: &Fit) -> bool {
        if fit.is_strained() {
            return false;
        }
        let over_floor = || problem.gap_over_floor(fit);
        let leaves_little = self.leaves_little(fit);
        if leaves_little && over_floor() <= FLOOR_DOUBT {
            return true;
        }
        let perfect = Perfect::of(problem, fit);
        // After some impacts even the right model has lost its way.
        let mut terms = fit.hypothesis.terms.iter();
        let bounces = |t: &Term| effects::of(t.kind.name).landscape() == Landscape::Rugged;
        let perfect = if terms.any(bounces) {
            perfect
        } else {
            perfect.bounded()
        };
        let as_foretold = || (1.0 / QUIET_GAP..QUIET_GAP).contains(&over_floor());
        is_quiet(fit, &perfect) && (leaves_little || as_foretold())
    }
}

/// True if a fit leaves no more than a perfect model may, in the mean and in the worst window, and the model's own
/// numbers need not move farther for it than their tolerances let one expect.
fn is_quiet(fit: &Fit, perfect: &Perfect) -> bool {
    let windows = 0..fit.costs.per_sample.len();
    let worst = windows.fold(0.0f64, |worst, w| worst.max(fit.costs.log(w)));
    fit.is_likely()
        && fit.costs.mean() - perfect.level <= QUIET_EXCESS + QUIET_ERRORS * perfect.error
        && worst - perfect.level <= perfect.worst + QUIET_WINDOW
}

impl Problem<'_> {
    /// True if a fit leaves no more of the gap than noise and restarts do, and need not bend the model's own numbers for it.
    fn is_at_floor(&self, fit: &Fit) -> bool {
        !fit.is_strained() && self.gap_over_floor(fit) <= FLOOR_DOUBT
    }
}

fn level(fit: &Fit) -> f64 {
    fit.costs.level()
}

/// Finds the effect that explains most, or the two that do together, then what is left beside them, each
/// fitted jointly with the others, and with the terms of `base`, which say numbers of the model that are not stated.
pub(crate) fn select(
    problem: &Problem<'_>,
    base: Option<Fit>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Selection {
    progress(Stage::Nominal);
    let bare = || {
        let bare = Hypothesis { terms: Vec::new() };
        let x = vec![0.0; bare.dimensions(&problem.nudges)];
        let null = problem.fit(&bare, x, Part::All, NULL_ITERATIONS);
        problem.nominal_afar(&null, NULL_ITERATIONS).unwrap_or(null)
    };
    let null = base.unwrap_or_else(bare);
    let found = select_beyond(null.clone(), problem, given, progress);
    let Some(ripple) = found.unrepeated(problem) else {
        return found;
    };
    pulls(&found, ripple, null, problem, given, progress).unwrap_or(found)
}

/// What is found without a ripple of which less than a wave was travelled, if that does as much.
fn pulls(
    found: &Selection,
    ripple: &'static str,
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Option<Selection> {
    let mut without = given.clone();
    without.excluded.push(ripple);
    let pulls = select_beyond(null, problem, &without, progress);
    let [rippled, pulled] = [found.rounds.last()?, pulls.rounds.last()?];
    let suffice = pulls.rounds.len() <= MOST_PULLS && pulls.suffices(problem, &pulled.so_far);
    let do_as_much = !is_far_likelier(&rippled.rivals[0], &pulled.rivals[0]);
    (suffice && do_as_much).then_some(pulls)
}

/// The same beyond what the nominal model leaves.
fn select_beyond(
    null: Fit,
    problem: &Problem<'_>,
    given: &Given<'_>,
    progress: fn(Stage),
) -> Selection {
    let perfect = Perfect::of(problem, &null);
    let mut selection = Selection {
        quiet: is_quiet(&null, &perfect) && problem.gap_over_floor(&null) <= LOUD_GAP,
        plain: null.costs.mean() - perfect.level > PLAIN_EXCESS + QUIET_ERRORS * perfect.error
            || problem.loudest_over_floor(&null) > LOUD_RUN,
        perfect: perfect.bounded(),
        null,
        given: false,
        rounds: Vec::new(),
        last: None,
    };
    // What two columns show is there, whatever the tolerances could make of it.
    let is_hidden = || !given.certain && selection.null_leaves_at_most(FLOOR_DOUBT, problem);
    selection.quiet |= !selection.plain && (!given.is_gap || is_hidden());
    if selection.quiet {
        return selection;
    }
    let search = Search {
        problem,
        given,
        progress,
        perfect: selection.perfect,
    };
    let certain = given.measured.as_ref().filter(|_| given.certain);
    let first = match certain {
        Some(term) => Some(search.given(&selection.null, term)),
        None => search.round(&selection.null, &[], 0.0),
    };
    let Some(mut first) = first else {
        return selection;
    };
    selection.given = certain.is_some();
    if let Some(null) = search.nominal_beside(&first) {
        return select_beyond(null, problem, given, progress);
    }
    let mut suffices = selection.suffices(problem, &first.so_far);
    if selection.left(&first.so_far) < MOST_LEFT_BY_ONE
        && !selection.given
        && !suffices
        && let Some(anew) = search.begun_afar(&first)
    {
        suffices = selection.suffices(problem, &anew.so_far);
        first = anew;
    }
    if first.place.earned && suffices {
        selection.add(first);
        return selection;
    }
    let hints = first.screened.clone();
    // Where the gap is at its floor, what else there may be stands beside the first, not in its place.
    let leaves_little =
        selection.leaves_little(&first.so_far) || problem.is_at_floor(&first.so_far);
    let settled = selection.given || first.place.earned && leaves_little;
    let saves = |cost: &dyn Fn(&Fit) -> f64| {
        cost(&selection.null) - cost(&first.so_far) > LEAST_SAVED_ALONE
    };
    let promises = || {
        selection.left(&first.so_far) < 1.0 - LEAST_GAIN_ALONE
            || saves(&level)
            // Of a gap that is in few windows most of them know nothing.
            || saves(&|fit| 2.0 * problem.gap_over_floor(fit).ln())
    };
    // Where none does much alone, no second is looked for on top of any.
    let pair = |lead: bool| search.pair(&first, lead, |both| !selection.is_hopeless(both));
    let rounds = (!settled).then(|| pair(promises())).flatten();
    // One of the two may do what both do.
    let is_pair = rounds.is_some();
    let found = selection.with(rounds.unwrap_or_else(|| vec![first.clone()]));
    let is_alone = is_pair && found.rounds.len() == 1;
    if is_alone && found.suffices(problem, found.fit()) {
        return found;
    }
    let found = search.extended(found, &hints);
    if !settled || selection.given {
        return found;
    }
    // What leaves little of the excess may still stand in for two that leave less of the gap, or at the floor for two that are
    // far likelier.
    let left = problem.gap_over_floor(found.fit());
    let is_near = left <= QUIET_GAP;
    if is_near && (found.rounds.len() > 1 || found.suffices(problem, found.fit())) {
        return found;
    }
    let Some(pair) = pair(!is_near).map(|rounds| selection.with(rounds)) else {
        return found;
    };
    let is_better = match (&pair.rounds[..], &found.rounds[..]) {
        _ if !is_near => problem.gap_over_floor(pair.fit()) < left,
        ([_, both], [one]) => is_far_likelier(&both.rivals[0], &one.rivals[0]),
        _ => false,
    };
    if is_better { pair } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    /// What is found of some effects, in the order of the alphabet.
    fn found(hidden: &[&str]) -> Vec<&'static str> {
        let recording = made::recording(hidden);
        let selection = select(&made::problem(&recording), None, &Given::A_GAP, |_| {});
        let rounds = selection.rounds.iter();
        let mut names: Vec<&str> = rounds.map(|round| round.rivals[0].name).collect();
        names.sort_unstable();
        names
    }

    #[test]
    fn friction_that_drifts_from_another_level_is_another_level_too() {
        let friction = found(&["coulomb:level=0.007", "friction_drift:rate=0.1,settling=0"]);
        assert_eq!(friction, ["coulomb", "friction_drift"]);
    }
}
