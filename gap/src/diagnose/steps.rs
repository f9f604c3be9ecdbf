//! The shrink of the gap by each effect in turn on held-out windows, and the withdrawal of effects that together explain nothing.

use crate::effects;
use crate::fit::Fit;
use crate::fit::part::Part;
use crate::fit::problem::Problem;
use crate::floor::FLOOR_DOUBT;
use crate::select::{self, Rival, Round, Selection};
use crate::shrink::shrink;

/// Share of the gap below which an effect closes little.
const LEAST_SHRINK: f64 = 0.05;

/// Share of the gain of an effect that presliding must reach for the effect to count as another form of presliding.
const NEARLY_ALL: f64 = 0.8;

/// Number of iterations of the fit without an effect.
const ITERATIONS_WITHOUT: usize = 8;

/// Shrink by one effect, and by all effects up to it, each with its 95 % interval.
pub(super) struct Step {
    pub own: [f64; 3],
    pub total: [f64; 3],
    /// True if the gap was at its floor without this effect.
    was_at_floor: bool,
}

impl Step {
    /// Limits the total shrink of all steps to `most`, and scales all steps in proportion.
    pub(super) fn limit(steps: &mut [Self], most: f64) {
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

    /// True if the effect closes little of the gap.
    pub(super) fn is_small(&self) -> bool {
        self.own[0] < LEAST_SHRINK
    }
}

/// The fit without the effect at `place`, started from the fitted parameters of the others.
fn without(problem: &Problem<'_>, selection: &Selection, place: usize) -> Fit {
    let (hypothesis, x) = selection.fit().without(selection.base() + place);
    problem.fit(&hypothesis, x, Part::All, ITERATIONS_WITHOUT)
}

/// True if the other effects close as much of the gap without the one at `place`.
pub(super) fn is_redundant(problem: &Problem<'_>, selection: &Selection, place: usize) -> bool {
    selection.rounds.len() > 1 && additional_shrink(problem, selection, place) < LEAST_SHRINK
}

/// Share of the gap that the effect at `place` closes in addition to all others.
fn additional_shrink(problem: &Problem<'_>, selection: &Selection, place: usize) -> f64 {
    let all = selection.fit();
    let others = self::without(problem, selection, place);
    let [without, with] = [&others, all].map(|fit| problem.window_squares(fit, Part::All));
    let nominal = problem.nominal_squares();
    shrink(&without, &with, &problem.floor_squares(all), &nominal)[0]
}

/// The steps of a selection, and the sum of squared residuals of each window on held-out data.
pub(super) struct Closed {
    pub steps: Vec<Step>,
    pub after: Vec<f64>,
}

/// The step of each effect of a selection. If the effects together explain nothing, they are withdrawn.
pub(super) fn closing_steps(problem: &Problem<'_>, selection: &mut Selection) -> Closed {
    let (steps, mut residuals) = steps_after_withdrawal(problem, selection);
    residuals.truncate(steps.len() + 1);
    let after = residuals.pop().unwrap_or_default();
    Closed { steps, after }
}

fn steps_after_withdrawal(
    problem: &Problem<'_>,
    selection: &mut Selection,
) -> (Vec<Step>, Vec<Vec<f64>>) {
    let kept = selection.kept();
    if selection.rounds.len() > kept && selection.leaves_most(problem) {
        selection.withdraw(kept);
    }
    let residuals = residuals_by_step(problem, selection);
    let mut steps = steps(problem, selection.fit(), &residuals);
    if kept > 0 {
        return (steps, residuals);
    }
    // A gap as large as the residual of an exact nominal model is no gap.
    let hidden = |floors| selection.null_leaves_at_most(floors, problem);
    let closes_none = |step: &Step| {
        step.was_at_floor || explain_no_more_than_tolerances(problem, selection, &residuals)
    };
    // An excess in every window without a gap may be caused by the step size of another simulator.
    let is_faint = || {
        !selection.is_unambiguous || !significantly_close(&steps) && hidden(select::ADEQUATE_GAP)
    };
    let is_none = !selection.is_measured()
        && hidden(select::PLAIN_GAP)
        && (is_formulation(selection) || is_faint() && steps.first().is_some_and(closes_none));
    if is_none || are_insignificant(&steps, selection.left(selection.fit())) {
        steps.clear();
        selection.withdraw(0);
        selection.has_no_gap |= is_none;
    }
    (steps, residuals)
}

/// True if the steps together significantly close a part of the gap.
fn significantly_close(steps: &[Step]) -> bool {
    steps.last().is_some_and(|step| step.total[1] > 0.0)
}

/// True if the only effect is another form of Coulomb friction, as presliding is.
fn is_formulation(selection: &Selection) -> bool {
    matches!(&selection.rounds[..], [round] if is_explained_by_presliding(round))
}

/// True if the effect of a round is presliding, or if presliding explains nearly as much.
fn is_explained_by_presliding(round: &Round) -> bool {
    let gain = |rival: &Rival| round.known.costs.level() - rival.fit.costs.level();
    let most = gain(&round.rivals[0]);
    let mut presliding = round
        .rivals
        .iter()
        .filter(|r| effects::of(r.name).reformulates_friction());
    presliding.any(|rival| gain(rival) >= NEARLY_ALL * most)
}

/// True if the effects close hardly more than the model parameters alone do within their tolerances.
fn explain_no_more_than_tolerances(
    problem: &Problem<'_>,
    selection: &Selection,
    residuals: &[Vec<f64>],
) -> bool {
    let [nominal, .., after] = residuals else {
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

/// True if the squares `after` are hardly less than those `before`, above a floor and as a share of the gap of the nominal model.
fn hardly_closes(floor: &[f64], nominal: &[f64], before: &[f64], after: &[f64]) -> bool {
    shrink(before, after, floor, nominal)[0] < LEAST_SHRINK
}

/// Sum of squared residuals of each window: of the nominal model, and after each effect in turn on held-out data.
fn residuals_by_step(problem: &Problem<'_>, selection: &Selection) -> Vec<Vec<f64>> {
    let nominal = problem.nominal_squares();
    let residuals = selection.rounds.iter().map(|round| {
        if round.acceptance.by_few {
            problem.window_squares(&round.so_far, Part::All)
        } else {
            problem.held_out(&round.so_far, |fit, half| problem.window_squares(fit, half))
        }
    });
    [nominal].into_iter().chain(residuals).collect()
}

/// The steps of the effects in their order, above the floor of the `fit` with all effects.
fn steps(problem: &Problem<'_>, fit: &Fit, residuals: &[Vec<f64>]) -> Vec<Step> {
    if residuals.len() > 1 {
        steps_to(&problem.floor_squares(fit), residuals)
    } else {
        Vec::new()
    }
}

/// The steps of the effects in their order, above a `floor`. `residuals` holds the sums of squared residuals of each window of the
/// nominal model, and then after each effect.
fn steps_to(floor: &[f64], residuals: &[Vec<f64>]) -> Vec<Step> {
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let is_at_floor = |residuals: &[f64]| sum(residuals) <= FLOOR_DOUBT.powi(2) * sum(floor);
    let nominal = &residuals[0];
    let steps = residuals
        .iter()
        .zip(&residuals[1..])
        .map(|(before, after)| Step {
            own: shrink(before, after, floor, nominal),
            total: shrink(nominal, after, floor, nominal),
            was_at_floor: is_at_floor(before),
        });
    steps.collect()
}

/// True if the effects do not shrink the gap. Also true if they do not significantly shrink it and leave most of the excess, or if there
/// are several effects, none of them significant, and they leave much of the excess.
fn are_insignificant(steps: &[Step], excess_left: f64) -> bool {
    let Some(last) = steps.last() else {
        return false;
    };
    let closes_nothing =
        last.total[0] <= 0.0 || !significantly_close(steps) && excess_left > select::MOST_LEFT;
    let none_is_sure = steps.len() > 1 && steps.iter().all(|step| step.own[1] <= 0.0);
    closes_nothing || none_is_sure && excess_left > select::MOST_LEFT_EXPLAINED
}

#[cfg(test)]
mod tests {
    use super::{Step, hardly_closes, is_explained_by_presliding, significantly_close, steps_to};
    use crate::fit::Fit;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::Hypothesis;
    use crate::select::{Acceptance, Rival, Round};

    const FLOOR: [f64; 20] = [1.0; 20];

    #[test]
    fn a_step_states_whether_it_begins_at_the_floor() {
        let places = |residuals: [f64; 3]| {
            let residuals = residuals.map(|squares| vec![squares; FLOOR.len()]);
            let steps = steps_to(&FLOOR, &residuals);
            steps.iter().map(|s| s.was_at_floor).collect::<Vec<_>>()
        };
        assert_eq!(places([9.0, 4.0, 1.2]), [false, false]);
        assert_eq!(places([1.3, 1.0, 1.0]), [true, true]);
    }

    #[test]
    fn the_total_shrink_of_steps_is_limited() {
        let residuals = [25.0, 9.0, 1.0].map(|squares| vec![squares; FLOOR.len()]);
        let mut steps = steps_to(&FLOOR, &residuals);
        Step::limit(&mut steps, 1.2);
        assert_eq!(steps[1].total[0], 1.0);
        Step::limit(&mut steps, 0.6);
        assert!((steps[1].total[0] - 0.6).abs() < 1e-12);
        assert!((steps[0].own[0] - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_shrink_that_one_window_reverses_is_not_significant() {
        let nominal = vec![4.0; FLOOR.len()];
        let mut after = vec![3.0; FLOOR.len()];
        let significant = |after: &[f64]| {
            significantly_close(&steps_to(&FLOOR, &[nominal.clone(), after.to_vec()]))
        };
        assert!(significant(&after));
        after[7] += 16.0;
        assert!(!significant(&after));
    }

    #[test]
    fn an_effect_that_closes_no_more_than_tolerances_hardly_closes() {
        let [nominal, moved] = [100.0, 5.0].map(|squares| [squares; FLOOR.len()]);
        let hardly = |after| hardly_closes(&FLOOR, &nominal, &moved, &[after; FLOOR.len()]);
        assert!(hardly(4.5) && hardly(6.0));
        assert!(!hardly(1.0));
    }

    #[test]
    fn the_shares_of_steps_add_up() {
        let residuals = [25.0, 9.0, 1.0, 0.9].map(|squares| vec![squares; FLOOR.len()]);
        let steps = steps_to(&FLOOR, &residuals);
        let own: Vec<f64> = steps.iter().map(|step| step.own[0]).collect();
        assert_eq!(own, [0.5, 0.5, 0.0]);
        assert_eq!(steps[2].total[0], 1.0);
        assert!(!steps[1].is_small() && steps[2].is_small());
    }

    #[test]
    fn an_effect_that_presliding_nearly_equals_is_another_form_of_it() {
        let fit = |level: f64| Fit {
            hypothesis: Hypothesis { terms: Vec::new() },
            x: Vec::new(),
            std: Vec::new(),
            costs: Costs {
                per_sample: vec![level.exp_m1(); 20],
                prior: 0.0,
            },
        };
        let is_explained_by_presliding = |rivals: &[(&'static str, f64)]| {
            let rivals = rivals.iter().map(|&(name, level)| Rival {
                name,
                fit: fit(level),
            });
            is_explained_by_presliding(&Round {
                known: fit(2.0),
                so_far: fit(1.0),
                rivals: rivals.collect(),
                screened: Vec::new(),
                acceptance: Acceptance::given(false),
                measured: None,
            })
        };
        assert!(is_explained_by_presliding(&[("presliding", 1.0)]));
        assert!(is_explained_by_presliding(&[
            ("compliance", 1.0),
            ("presliding", 1.1)
        ]));
        assert!(!is_explained_by_presliding(&[
            ("compliance", 1.0),
            ("presliding", 1.5)
        ]));
        assert!(!is_explained_by_presliding(&[
            ("compliance", 1.0),
            ("viscous", 1.1)
        ]));
    }
}
