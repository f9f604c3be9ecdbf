//! Hard stops at the ends of the travel.

use super::description::Demonstration;
use super::gravity::Gravity;
use super::identification::{Fitted, Identification};
use super::phrase::{Found, Part, Phrase};
use super::spring::Spring;
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::contact::contact_starts;
use crate::guess::start::{linear, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::end_stop::KIND;
use host_sim::plant::Mechanics;
use recording::Model;

/// Shares of the samples that lie beyond a stop at the start; 0 for a stop that is touched once.
const STOPPED_SHARES: [f64; 3] = [0.0, 0.005, 0.05];
/// Stiffness of a stop at the start, over rms torque by range of the motion.
const STIFFNESSES: [f64; 2] = [20.0, 200.0];
/// Damping ratio of a stop at the start.
const STOP_DAMPING: f64 = 0.1;
/// Unit of the coordinate of a moved stop of the model, as a share of the range of the motion.
const MOVED_UNIT: f64 = 0.1;
/// Distance from the motion at which a stop is out of reach, in ranges of the motion.
const OUT_OF_REACH: f64 = 10.0;
/// Depths of a stop within the motion that are screened for the missing torque, over half of the range.
const DEPTHS_SCREENED: [f64; 11] = [
    0.003, 0.006, 0.012, 0.02, 0.03, 0.045, 0.07, 0.11, 0.18, 0.3, 0.5,
];

#[derive(Debug)]
pub(super) struct EndStop;

impl Identification for EndStop {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Starts with one stop and the other out of reach, then with both. Stops of the model that the device passed are also tried farther
    /// out.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let inertia = e.device.mechanics.inertia;
        let positions = e.motions.iter().flat_map(|m| m.position.iter().copied());
        let positions: Vec<f64> = positions.collect();
        let far = untouched(e.model.travel, s.position);
        let ends = |share: f64| [share, 1.0 - share].map(|share| quantile(&positions, share));
        let ends = STOPPED_SHARES.map(ends);
        let mut all = stops_from_contacts(e, far);
        all.extend(moved_model_stops(e.model, ends[0]));
        let sizes = ends
            .iter()
            .flat_map(|&ends| STIFFNESSES.map(|hardness| (ends, hardness)));
        for (ends, hardness) in sizes {
            for [lower, upper] in stop_pairs(ends, far) {
                let stiffness = hardness * s.torque / s.span();
                let damping = 2.0 * STOP_DAMPING * (stiffness * inertia).sqrt();
                let mut free = vec![log(2, stiffness), log(3, damping)];
                if lower > far[0] {
                    free.push(linear(0, lower, 0.05 * s.span()));
                }
                if upper < far[1] {
                    free.push(linear(1, upper, 0.05 * s.span()));
                }
                all.push(term(&KIND, free, &[(0, lower), (1, upper)]));
            }
        }
        all
    }

    fn reduced_forms(
        &self,
        fitted: &Term,
        x: &[f64],
        model: &Model,
        extremes: [f64; 2],
    ) -> Vec<(Term, Vec<f64>)> {
        one_sided(fitted, x, untouched(model.travel, extremes))
    }

    fn is_local(&self) -> bool {
        true
    }

    fn may_show_in_few_windows(&self) -> bool {
        true
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset, &Gravity, &Spring]
    }

    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        let positions = fit.series.iter().flat_map(|s| s.position.iter().copied());
        acts_at_most_positions(fit.term, positions)
    }

    fn axis(&self) -> Axis {
        Axis::Position
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let forms = [-1.0, 1.0].into_iter().flat_map(|side| {
            let depths = DEPTHS_SCREENED.into_iter();
            depths.map(move |part| stop_form(path, side, part * path.scale.half_span()))
        });
        let mut forms = target.screened(forms.collect(), 3);
        if path.device.mechanics.barriers.iter().any(Option::is_some) {
            let mut free = path.device.clone();
            free.mechanics.barriers = Mechanics::inertia(1.0).barriers;
            let far = path.scale.half_span();
            let [low, high] = path.scale.range;
            let values = move |_: &[f64]| with_defaults(&KIND, &[(0, low - far), (1, high + far)]);
            forms.push(Form::new(vec![path.added_torque(&free)], values).positive());
        }
        forms
    }

    fn noun(&self) -> &'static str {
        "a hard stop"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque is zero up to a position and steep beyond. A spring pulls everywhere. A contact is there for a while only. Record motion that reaches both ends of the travel slowly."
    }

    fn demonstration(&self) -> Demonstration {
        Demonstration {
            numbers: &[("lower", -0.15), ("upper", 0.15)],
            ..Demonstration::USUAL
        }
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a hard stop"
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        // A stop that was not fitted is out of reach.
        let stops = ["lower", "upper"].map(|side| found.fitted(side).cloned());
        match stops {
            [Some(one), None] | [None, Some(one)] => Phrase(vec![
                Part::Words("a hard stop at ".into()),
                Part::Number(one),
            ]),
            [Some(lower), Some(upper)] => Phrase(vec![
                Part::Words("hard stops at ".into()),
                Part::Number(lower),
                Part::Words(" and ".into()),
                Part::Number(upper),
            ]),
            [None, None] if found.nominal.has_stops => {
                Phrase::of("stops that are not met where the model has them")
            }
            [None, None] => Phrase::of(self.noun()),
        }
    }
}

/// One stop at an end of the motion with the other at `far`, then both at the ends. No stop is tried beyond a known one.
fn stop_pairs([low, high]: [f64; 2], far: [f64; 2]) -> Vec<[f64; 2]> {
    let (low, high) = (low.max(far[0]), high.min(far[1]));
    let mut pairs = vec![[far[0], high], [low, far[1]], [low, high]];
    pairs.retain(|pair| *pair != far);
    pairs.dedup();
    pairs
}

/// The stops of the model that the motion passed, one or both of them moved out of reach or to the ends of the motion.
fn moved_model_stops(model: &Model, extremes: [f64; 2]) -> Vec<Term> {
    let Some(travel) = model.travel else {
        return Vec::new();
    };
    let passed = [extremes[0] < travel[0], extremes[1] > travel[1]];
    let moved = [vec![0], vec![1], vec![0, 1]].into_iter();
    let moved = moved.filter(|sides| sides.iter().all(|&side| passed[side]));
    let unit = MOVED_UNIT * (extremes[1] - extremes[0]);
    let hardness = [(2, model.stop_stiffness), (3, model.stop_damping)];
    let own = term(&KIND, Vec::new(), &hardness);
    let own = own.starting_at(&[(0, travel[0]), (1, travel[1])]);
    let stops = moved.flat_map(|sides| {
        [untouched(None, extremes), extremes].map(|positions| {
            let targets: Vec<_> = sides.iter().map(|&side| (side, positions[side])).collect();
            let free = targets.iter().map(|&(side, at)| linear(side, at, unit));
            Term {
                free: free.collect(),
                ..own.starting_at(&targets)
            }
        })
    });
    stops.collect()
}

/// Starts of a stop at the positions of temporary contacts, with the other stop at `far`.
fn stops_from_contacts(e: &Evidence<'_>, far: [f64; 2]) -> Vec<Term> {
    let mut pushes = contact_starts(e, &[1.0, -1.0]);
    // A stop has no duration.
    pushes.dedup_by_key(|push| (push.position.to_bits(), push.side.to_bits()));
    let stops = pushes.into_iter().map(|push| {
        let upper = usize::from(push.side > 0.0);
        let free = vec![
            log(2, push.stiffness),
            log(3, push.damping),
            linear(upper, push.position, 0.1 * push.span),
        ];
        term(&KIND, free, &[(1 - upper, far[1 - upper])])
    });
    stops.collect()
}

/// Positions of the stops that a motion between `extremes` does not touch: those of the nominal model, or positions out of reach.
fn untouched(travel: Option<[f64; 2]>, extremes: [f64; 2]) -> [f64; 2] {
    let [low, high] = extremes;
    let away = OUT_OF_REACH * (high - low);
    travel.unwrap_or([low - away, high + away])
}

/// True if the stops act at most of the positions, which is not a stop.
fn acts_at_most_positions(stops: &Term, positions: impl Iterator<Item = f64>) -> bool {
    let [lower, upper] = [stops.values[0], stops.values[1]];
    let pushes = |x: f64| if (lower..=upper).contains(&x) { -1 } else { 1 };
    positions.map(pushes).sum::<i64>() > 0
}

/// The terms with only one of two stops that were fitted at `x`, with the coordinates of each. The other stop is at its position in
/// `untouched`.
fn one_sided(stops: &Term, x: &[f64], untouched: [f64; 2]) -> Vec<(Term, Vec<f64>)> {
    let place = |stop: usize| stops.free.iter().position(|c| c.parameter == stop);
    let (Some(lower), Some(upper)) = (place(0), place(1)) else {
        return Vec::new();
    };
    let without = |(stop, at): (usize, usize)| {
        let (mut term, mut x) = (stops.clone(), x.to_vec());
        term.values[stop] = untouched[stop];
        term.free.remove(at);
        x.remove(at);
        (term, x)
    };
    [(0, lower), (1, upper)].map(without).into()
}

/// The form of a stop at the lower (`side` −1) or upper (1) end of the motion. `depth` is the distance between the stop and the end of
/// the motion.
fn stop_form(path: &Path<'_>, side: f64, depth: f64) -> Form {
    let [low, high] = path.scale.range;
    let at = if side > 0.0 { high } else { low } - side * depth;
    let depth_at = |i: usize| side * (path.position[i] - at);
    let steps = 0..path.position.len();
    let push = steps.clone().map(|i| -side * depth_at(i).max(0.0) / depth);
    let damp = steps.map(|i| {
        if depth_at(i) > 0.0 {
            -path.velocity[i] / path.scale.velocity
        } else {
            0.0
        }
    });
    let columns = vec![push.collect(), damp.collect()];
    let per_speed = path.scale.velocity;
    let far = 100.0 * path.scale.half_span();
    let [lower, upper] = if side > 0.0 {
        [low - far, at]
    } else {
        [at, high + far]
    };
    let form = Form::new(columns, move |c| {
        let (k, d) = (c[0].max(0.0) / depth, c[1].max(0.0) / per_speed);
        vec![lower, upper, k, d]
    });
    form.searched(2).seldom().positive()
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn stops_that_act_at_most_positions_are_recognized() {
        let at = |lower| term(&KIND, Vec::new(), &[(0, lower), (1, 0.5)]);
        let positions = || [-0.2, -0.1, 0.0, 0.1, 0.2].into_iter();
        assert!(!acts_at_most_positions(&at(-0.15), positions()));
        assert!(acts_at_most_positions(&at(0.05), positions()));
        assert!(acts_at_most_positions(&at(0.6), positions()));
    }

    #[test]
    fn no_stop_is_tried_beyond_a_known_one() {
        let known = [-0.61, 0.61];
        assert_eq!(stop_pairs([-0.63, 0.4], known), [[-0.61, 0.4]]);
        assert_eq!(stop_pairs([-0.63, 0.65], known), [[0.0; 2]; 0]);
        let all = [[-0.61, 0.4], [-0.3, 0.61], [-0.3, 0.4]];
        assert_eq!(stop_pairs([-0.3, 0.4], known), all);
    }

    #[test]
    fn a_stop_that_is_not_fitted_keeps_its_position_in_the_model() {
        let free = vec![linear(0, -0.2, 0.1), linear(1, 0.3, 0.1), log(2, 20.0)];
        let both = term(&KIND, free, &[]);
        let positions = |travel| {
            let singles = one_sided(&both, &[0.5, 0.0, 0.1], untouched(travel, [-0.2, 0.3]));
            let hundredths = |place: &f64| (100.0 * place).round();
            let positions = singles
                .iter()
                .map(|(term, x)| term.at(x)[..2].iter().map(hundredths).collect::<Vec<_>>());
            positions.collect::<Vec<_>>()
        };
        assert_eq!(
            positions(Some([-0.6, 0.6])),
            [vec![-60.0, 30.0], vec![-15.0, 60.0]]
        );
        assert_eq!(positions(None)[0], [-520.0, 30.0]);
    }
}
