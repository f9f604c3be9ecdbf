//! By how much each effect in turn closes the gap on held-out windows, and which effects are withdrawn because they close too little.

use super::relief::is_relieved;
use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::select::{self, Rival, Round, Selection};
use crate::shrink::{resampled, shrink};

/// Share of the gap that a further effect must close, or share of what the effects before it leave.
const LEAST_SHRINK: f64 = 0.05;
const LEAST_SHRINK_OF_REST: f64 = 0.5;
/// Share of the gap that a right effect in another formulation may leave. An effect that closes no more than that is none.
const FORMULATION: f64 = 0.02;
/// Share of the robust excess that it may close instead, if it surely closes something of the gap, or leaves hardly any excess: a few
/// windows in which a hidden state is wrong may be most of the gap.
const LEAST_TYPICAL_SHRINK: f64 = 0.2;

/// Share of the gap that an episode must close, unless it closes all of it. An episode is found in few windows, which cannot be held out,
/// and fits whatever is missing there. Of 31 contacts on five blind and outside sets eight closed less, and none of these was right; the
/// right ones closed a third or more.
const LEAST_EPISODE_SHRINK: f64 = 0.25;

/// Share of the excess closed by an effect that bristles must close, too, for the effect to be another form of them.
const NEARLY_ALL: f64 = 0.8;

/// Iterations of the fit without an effect, to see what it closes.
const SPARED_ITERATIONS: usize = 8;

/// Shrink by one effect, and by all effects up to it, each with its 95 % interval.
pub(super) struct Step {
    pub own: [f64; 3],
    /// Share of what the effects before it left.
    of_rest: f64,
    pub total: [f64; 3],
    /// True if the gap was at its floor without this effect.
    was_at_floor: bool,
    /// True if the gap is at its floor with it.
    is_at_floor: bool,
    /// True if it surely closes something.
    is_sure: bool,
}

impl Step {
    /// Limits the shrink of all steps together to `most`, and each in proportion.
    pub(super) fn bounded(steps: &mut [Self], most: f64) {
        let Some(whole) = steps.last().map(|step| step.total[0]) else {
            return;
        };
        if whole <= most.max(0.0) {
            return;
        }
        for step in steps {
            for shrink in [&mut step.own, &mut step.total] {
                *shrink = shrink.map(|of_whole| of_whole * most / whole);
            }
        }
    }

    /// True if its effect closes less than a further effect must.
    pub(super) fn is_small(&self) -> bool {
        self.own[0] < LEAST_SHRINK
    }
}

/// The fit without the effect at `place`, begun at the numbers of the others.
fn without(problem: &Problem<'_>, selection: &Selection, place: usize) -> Fit {
    let (hypothesis, x) = selection.fit().without(selection.base() + place);
    problem.fit(&hypothesis, x, Part::All, SPARED_ITERATIONS)
}

/// The fit without the last effect, if that closes little and the others explain as much without it: the fit beside it has only had more
/// iterations.
fn without_needless(problem: &Problem<'_>, selection: &Selection, steps: &[Step]) -> Option<Fit> {
    let further = selection.kept().max(1)..selection.rounds.len();
    let last = further.last().filter(|&last| steps[last].is_small())?;
    let all = selection.fit();
    let others = without(problem, selection, last);
    let enough = all.costs.level() + select::chance_gain(all);
    (others.costs.level() <= enough).then_some(others)
}

/// True if the other effects close as much of the gap without the one at `place`.
pub(super) fn is_spare(problem: &Problem<'_>, selection: &Selection, place: usize) -> bool {
    selection.rounds.len() > 1 && closed_beside(problem, selection, place) < LEAST_SHRINK
}

/// Share of the gap that the effect at `place` closes beside all others.
fn closed_beside(problem: &Problem<'_>, selection: &Selection, place: usize) -> f64 {
    let all = selection.fit();
    let others = self::without(problem, selection, place);
    let [without, with] = [&others, all].map(|fit| problem.window_squares(fit, Part::All));
    let nominal = problem.nominal_squares();
    shrink(&without, &with, &problem.floor_squares(all), &nominal)[0]
}

/// The steps of a selection, and the squared residuals of each window on data that its fit has not seen.
pub(super) struct Closed {
    pub steps: Vec<Step>,
    pub after: Vec<f64>,
}

/// The step of each effect of a selection, after those that close too little were withdrawn.
pub(super) fn closing_steps(problem: &Problem<'_>, selection: &mut Selection) -> Closed {
    let (steps, mut left) = surviving_steps(problem, selection);
    left.truncate(steps.len() + 1);
    let after = left.pop().unwrap_or_default();
    Closed { steps, after }
}

fn surviving_steps(problem: &Problem<'_>, selection: &mut Selection) -> (Vec<Step>, Vec<Vec<f64>>) {
    let kept = selection.kept();
    if selection.rounds.len() > kept && selection.leaves_most(problem) {
        selection.withdraw(kept);
    }
    let mut left = left_by_each(problem, selection);
    let mut steps = steps(problem, selection.fit(), &left);
    while let Some(others) = without_needless(problem, selection, &steps) {
        selection.withdraw_last(others);
        left = left_by_each(problem, selection);
        steps = self::steps(problem, selection.fit(), &left);
    }
    while let Some(idle) = (kept..steps.len()).find(|&i| is_idle(problem, selection, i, &steps[i]))
    {
        selection.withdraw_one(problem, idle);
        if idle < selection.rounds.len() {
            left = left_by_each(problem, selection);
        } else {
            left.truncate(idle + 1);
        }
        steps = self::steps(problem, selection.fit(), &left);
    }
    if kept > 0 {
        return (steps, left);
    }
    // A gap that the null could leave if it were exact is none.
    let hidden = |floors| selection.null_leaves_at_most(floors, problem);
    let closes_none = |step: &Step| step.was_at_floor || are_spared(problem, selection, &left);
    // Excess in every window without a gap may come from the step size of another simulator.
    let is_faint =
        || !selection.is_unambiguous || !surely_close(&steps) && hidden(select::ADEQUATE_GAP);
    let is_none = !selection.is_measured()
        && hidden(select::PLAIN_GAP)
        && (is_formulation(selection) || is_faint() && steps.first().is_some_and(closes_none));
    if is_none || are_vain(&steps, selection.left(selection.fit())) {
        steps.clear();
        selection.withdraw(0);
        selection.has_no_gap |= is_none;
    }
    (steps, left)
}

/// True if the steps together surely close something.
fn surely_close(steps: &[Step]) -> bool {
    steps.last().is_some_and(|step| step.total[1] > 0.0)
}

/// True if the only effect found is another form of dry friction: bristles in place of stick.
fn is_formulation(selection: &Selection) -> bool {
    matches!(&selection.rounds[..], [round] if is_as_bristles(round))
}

/// True if an effect is bristles, or if bristles explain nearly as much.
fn is_as_bristles(round: &Round) -> bool {
    let gain = |rival: &Rival| round.known.costs.level() - rival.fit.costs.level();
    let most = gain(&round.rivals[0]);
    let mut bristles = round
        .rivals
        .iter()
        .filter(|r| effects::of(r.name).reformulates_friction());
    bristles.any(|rival| gain(rival) >= NEARLY_ALL * most)
}

/// True if the effects close hardly more than the numbers of the model, moved within their tolerances.
fn are_spared(problem: &Problem<'_>, selection: &Selection, left: &[Vec<f64>]) -> bool {
    let [nominal, .., after] = left else {
        return false;
    };
    let moved = problem.held_out(&selection.null, |fit, half| {
        problem.window_squares(fit, half)
    });
    hardly_closes(
        &problem.floor_squares(selection.fit()),
        nominal,
        &moved,
        after,
    )
}

/// True if the squares `after` are hardly less than those `before`, above a floor and as a share of what the nominal model leaves.
fn hardly_closes(floor: &[f64], nominal: &[f64], before: &[f64], after: &[f64]) -> bool {
    shrink(before, after, floor, nominal)[0] < LEAST_SHRINK
}

/// Squared residuals of each window: of the nominal model, and with each effect in turn on data that its fit has not seen.
fn left_by_each(problem: &Problem<'_>, selection: &Selection) -> Vec<Vec<f64>> {
    let nominal = problem.nominal_squares();
    let left = selection.rounds.iter().map(|round| {
        if round.acceptance.by_few {
            problem.window_squares(&round.so_far, Part::All)
        } else {
            problem.held_out(&round.so_far, |fit, half| problem.window_squares(fit, half))
        }
    });
    [nominal].into_iter().chain(left).collect()
}

/// The steps of the effects in their order, above the floor of the `fit` with all of them.
fn steps(problem: &Problem<'_>, fit: &Fit, left: &[Vec<f64>]) -> Vec<Step> {
    if left.len() > 1 {
        steps_to(&problem.floor_squares(fit), left)
    } else {
        Vec::new()
    }
}

/// The steps of the effects in their order, above a `floor`. The squared residuals of each window are `left` by the nominal model, and
/// then with each effect in turn.
fn steps_to(floor: &[f64], left: &[Vec<f64>]) -> Vec<Step> {
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let is_at_floor = |left: &[f64]| sum(left) <= FLOOR_DOUBT.powi(2) * sum(floor);
    let nominal = &left[0];
    let steps = left.iter().zip(&left[1..]).map(|(before, after)| {
        let of_rest = shrink(before, after, floor, before)[0];
        let was_at_floor = is_at_floor(before);
        Step {
            own: shrink(before, after, floor, nominal),
            of_rest: if was_at_floor { 0.0 } else { of_rest },
            total: shrink(nominal, after, floor, nominal),
            was_at_floor,
            is_at_floor: is_at_floor(after),
            is_sure: resampled(before.len(), |sum| sum(before) - sum(after))[1] > 0.0,
        }
    });
    steps.collect()
}

/// True if the effect `i` closes too little of the gap, whatever it gains in robust cost. The first effect need not close any, unless it
/// is an episode.
fn is_idle(problem: &Problem<'_>, selection: &Selection, i: usize, step: &Step) -> bool {
    let winner = &selection.rounds[i].rivals[0];
    // An effect that contains another one of the selection only gives that another form.
    let mut others = selection.rounds.iter().map(|round| round.rivals[0].name);
    if step.is_small() && others.any(|other| effects::of(winner.name).contains(other)) {
        return true;
    }
    let comes_and_goes = effects::of(winner.name).episode().is_some();
    if comes_and_goes && step.own[0] < LEAST_EPISODE_SHRINK && !step.is_at_floor {
        // The effects after an episode may close most of what it leaves.
        return closed_beside(problem, selection, i) < LEAST_EPISODE_SHRINK;
    }
    if i == 0 || !step.is_small() {
        return false;
    }
    let [before, after] = [i - 1, i].map(|k| selection.left(&selection.rounds[k].so_far));
    let is_real = step.is_sure || after <= select::MOST_LEFT_EXPLAINED;
    // A gap that is at its floor cannot be closed further.
    let typical = !step.was_at_floor && before - after >= LEAST_TYPICAL_SHRINK && is_real;
    // A restart on a jump leaves a residual even for a right model, and that window may be most of what is left.
    let halves = after <= (1.0 - LEAST_SHRINK_OF_REST) * before;
    let jumps = winner.is_event() && !comes_and_goes;
    let jumps = jumps && (step.is_at_floor || halves);
    let finishes = step.own[0] >= FORMULATION && step.of_rest >= LEAST_SHRINK_OF_REST;
    // An effect may save numbers of the model an unlikely move, but not at the price of a larger gap.
    let relieves = step.own[0] > -LEAST_SHRINK && is_relieved(&selection.rounds[i]);
    !finishes && !typical && !jumps && !relieves
}

/// True if effects that leave the share `left_open` of the excess close nothing of the gap, or may close nothing and leave most of the
/// excess; or if there are several, each may close nothing, and they leave much. Of 415 diagnoses two were such, without a right name.
fn are_vain(steps: &[Step], left_open: f64) -> bool {
    let Some(last) = steps.last() else {
        return false;
    };
    let closes_nothing =
        last.total[0] <= 0.0 || !surely_close(steps) && left_open > select::MOST_LEFT;
    let none_is_sure = steps.len() > 1 && steps.iter().all(|step| step.own[1] <= 0.0);
    closes_nothing || none_is_sure && left_open > select::MOST_LEFT_EXPLAINED
}

#[cfg(test)]
mod tests {
    use super::{Step, hardly_closes, is_as_bristles, steps_to, surely_close};
    use crate::fit::Fit;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::Hypothesis;
    use crate::select::{Acceptance, Rival, Round};

    const FLOOR: [f64; 20] = [1.0; 20];

    #[test]
    fn a_step_says_where_it_began_and_where_it_ends() {
        let places = |left: [f64; 3]| {
            let left = left.map(|squares| vec![squares; FLOOR.len()]);
            let steps = steps_to(&FLOOR, &left);
            steps
                .iter()
                .map(|s| (s.was_at_floor, s.is_at_floor))
                .collect::<Vec<_>>()
        };
        assert_eq!(places([9.0, 4.0, 1.2]), [(false, false), (false, true)]);
        assert_eq!(places([1.3, 1.0, 1.0]), [(true, true), (true, true)]);
    }

    #[test]
    fn steps_claim_together_what_was_measured_at_most() {
        let left = [25.0, 9.0, 1.0].map(|squares| vec![squares; FLOOR.len()]);
        let mut steps = steps_to(&FLOOR, &left);
        Step::bounded(&mut steps, 1.2);
        assert_eq!(steps[1].total[0], 1.0);
        Step::bounded(&mut steps, 0.6);
        assert!((steps[1].total[0] - 0.6).abs() < 1e-12);
        assert!((steps[0].own[0] - 0.3).abs() < 1e-12);
    }

    #[test]
    fn what_one_window_loses_again_is_not_surely_closed() {
        let nominal = vec![4.0; FLOOR.len()];
        let mut after = vec![3.0; FLOOR.len()];
        let surely =
            |after: &[f64]| surely_close(&steps_to(&FLOOR, &[nominal.clone(), after.to_vec()]));
        assert!(surely(&after));
        after[7] += 16.0;
        assert!(!surely(&after));
    }

    #[test]
    fn what_tolerances_close_as_well_is_hardly_closed_by_an_effect() {
        let [nominal, moved] = [100.0, 5.0].map(|squares| [squares; FLOOR.len()]);
        let hardly = |after| hardly_closes(&FLOOR, &nominal, &moved, &[after; FLOOR.len()]);
        assert!(hardly(4.5) && hardly(6.0));
        assert!(!hardly(1.0));
    }

    #[test]
    fn shares_of_the_steps_make_up_the_whole_and_a_share_of_the_rest_is_none_at_the_floor() {
        let left = [25.0, 9.0, 1.0, 0.9].map(|squares| vec![squares; FLOOR.len()]);
        let steps = steps_to(&FLOOR, &left);
        let own: Vec<f64> = steps.iter().map(|step| step.own[0]).collect();
        assert_eq!(own, [0.5, 0.5, 0.0]);
        assert_eq!(steps[2].total[0], 1.0);
        assert_eq!(
            steps.iter().map(|s| s.of_rest).collect::<Vec<_>>(),
            [0.5, 1.0, 0.0]
        );
        assert!(steps[1].is_sure && steps[2].is_small());
    }

    #[test]
    fn what_bristles_explain_nearly_as_well_is_one_of_their_forms() {
        let fit = |level: f64| Fit {
            hypothesis: Hypothesis { terms: Vec::new() },
            x: Vec::new(),
            std: Vec::new(),
            costs: Costs {
                per_sample: vec![level.exp_m1(); 20],
                prior: 0.0,
            },
        };
        let is_as_bristles = |rivals: &[(&'static str, f64)]| {
            let rivals = rivals.iter().map(|&(name, level)| Rival {
                name,
                fit: fit(level),
            });
            is_as_bristles(&Round {
                known: fit(2.0),
                so_far: fit(1.0),
                rivals: rivals.collect(),
                screened: Vec::new(),
                acceptance: Acceptance::given(false),
                measured: None,
            })
        };
        assert!(is_as_bristles(&[("presliding", 1.0)]));
        assert!(is_as_bristles(&[("compliance", 1.0), ("presliding", 1.1)]));
        assert!(!is_as_bristles(&[("compliance", 1.0), ("presliding", 1.5)]));
        assert!(!is_as_bristles(&[("compliance", 1.0), ("viscous", 1.1)]));
    }
}
