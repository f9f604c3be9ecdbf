//! Proposes the excitation of the firmware that distinguishes rival models best.

mod contender;
mod menu;
mod separation;
mod trial;

use crate::diagnosis::NextExperiment;
use crate::fit::problem::Problem;
use crate::select::{Rival, Selection, ties};
use crate::windows::statistics::rms;
use contender::Contender;
use haptic_paddle::excitation::{Excitation, Shape};
use rayon::prelude::*;
use std::collections::BTreeMap;
use trial::Setting;

/// Number of readings in a horizon.
const TICKS: f64 = 250.0;
/// Largest number of rivals that are compared.
const MOST_RIVALS: usize = 4;
/// Distance by which the device may leave the recorded positions on each side if no travel is stated, as a share of their range.
const MARGIN: f64 = 0.5;
/// Least separation over the noise for an experiment to be useful.
const LEAST_SEPARATION: f64 = 1.0;
/// Number of shapes per rival that are evaluated with variable parameters.
const MOST_SHAPES: usize = 3;

/// An excitation, and the separation of the winner from each rival, over the noise.
type Trial = (Excitation, Vec<f64>);

/// The best excitation for rivals that the selection does not distinguish: the one that separates most rivals from the winner, and
/// separates these best. Returns `None` if there are no such rivals, if every excitation would drive a model out of its range, or if none
/// separates a rival.
pub(crate) fn separating(problem: &Problem<'_>, selection: &Selection) -> Option<NextExperiment> {
    let rivals = undecided_rivals(selection)?;
    let largest_input = largest_input(problem);
    if largest_input <= 0.0 {
        return None;
    }
    let contenders = rivals.par_iter().map(|r| Contender::new(problem, &r.fit));
    let contenders: Vec<Contender> = contenders.collect();
    let setting = setting(problem);
    let noise = noise(problem);
    let excitations = menu::excitations(largest_input, problem.recording.horizon);
    let as_fitted = excitations.into_par_iter().filter_map(|excitation| {
        let readings = |c: &Contender| c.readings(&excitation, &setting);
        let differences = distances(&contenders, readings, |a, b| {
            rms((a - b).as_slice()) / noise
        })?;
        Some((excitation, differences))
    });
    let promising = most_promising(as_fitted.collect(), rivals.len() - 1);
    let trials = promising.into_par_iter().filter_map(|excitation| {
        let linear_readings = |c: &Contender| c.linear_readings(&excitation, &setting);
        let separations = distances(&contenders, linear_readings, |a, b| a.separation(b, noise))?;
        Some((excitation, separations))
    });
    let trials: Vec<Trial> = trials.collect();
    let separated_rivals = |(_, separations): &Trial| {
        let separated_rivals = separations.iter().filter(|s| **s > LEAST_SEPARATION);
        (
            separated_rivals.clone().count(),
            separated_rivals.copied().fold(f64::INFINITY, f64::min),
        )
    };
    let best = trials.into_iter().max_by(|a, b| {
        let ((a, least_of_a), (b, least_of_b)) = (separated_rivals(a), separated_rivals(b));
        a.cmp(&b).then(least_of_a.total_cmp(&least_of_b))
    })?;
    let (separated, difference_over_noise) = separated_rivals(&best);
    let (excitation, separations) = best;
    let others = rivals[1..].iter().zip(&separations);
    let others = others.filter(|(_, s)| **s > LEAST_SEPARATION);
    (separated > 0).then(|| NextExperiment {
        kind: Shape::NAMED
            .iter()
            .find(|(_, shape)| *shape == excitation.shape)
            .map_or("", |(name, _)| name),
        separates: core::iter::once(rivals[0].name)
            .chain(others.map(|(r, _)| r.name))
            .collect(),
        settings: settings(&excitation),
        difference_over_noise,
    })
}

/// The best excitations for each rival, each with another shape. The separation is computed for fixed parameters, which is an upper
/// bound.
fn most_promising(trials: Vec<Trial>, rivals: usize) -> Vec<Excitation> {
    let mut promising: Vec<Excitation> = Vec::new();
    for rival in 0..rivals {
        let separated_rivals = trials.iter().filter(|(_, d)| d[rival] > LEAST_SEPARATION);
        let mut separated_rivals: Vec<&Trial> = separated_rivals.collect();
        separated_rivals.sort_by(|(_, a), (_, b)| b[rival].total_cmp(&a[rival]));
        let mut shapes: Vec<Shape> = Vec::new();
        for (excitation, _) in separated_rivals {
            if shapes.len() < MOST_SHAPES && !shapes.contains(&excitation.shape) {
                shapes.push(excitation.shape);
                if !promising.contains(excitation) {
                    promising.push(*excitation);
                }
            }
        }
    }
    promising
}

/// Noise of a reading including the allowed model error, in position units.
fn noise(problem: &Problem<'_>) -> f64 {
    let noises = problem.series.iter().flat_map(|s| &s.windows);
    let noise = rms(&noises.map(|w| w.noise).collect::<Vec<_>>());
    noise.hypot(problem.modelling).max(f64::MIN_POSITIVE)
}

/// The rivals that the recording does not distinguish: a winner and its ties in the last round that has any, or the best two if no effect
/// was accepted.
fn undecided_rivals(selection: &Selection) -> Option<Vec<&Rival>> {
    let mut tied = selection.rounds.iter().rev().filter_map(|round| {
        let names = ties(round);
        let (winner, others) = round.rivals.split_first()?;
        let others = others.iter().filter(|r| names.contains(&r.name));
        let all: Vec<&Rival> = core::iter::once(winner)
            .chain(others)
            .take(MOST_RIVALS)
            .collect();
        (all.len() > 1).then_some(all)
    });
    if let Some(all) = tied.next() {
        return Some(all);
    }
    let unexplained = selection.rounds.is_empty() && !selection.has_no_gap;
    let best = selection.last.as_ref()?.rivals.get(..2)?;
    unexplained.then(|| best.iter().collect())
}

/// The distance of the winner from each rival, by the readings that `readings_of` computes. Returns `None` if one of the models leaves
/// its range.
fn distances<S>(
    contenders: &[Contender],
    readings_of: impl Fn(&Contender) -> Option<S>,
    distance: impl Fn(&S, &S) -> f64,
) -> Option<Vec<f64>> {
    let readings: Vec<S> = contenders.iter().map(readings_of).collect::<Option<_>>()?;
    let (winner, others) = readings.split_first()?;
    Some(others.iter().map(|other| distance(winner, other)).collect())
}

/// The largest recorded input, within the limit of the model.
fn largest_input(problem: &Problem<'_>) -> f64 {
    let inputs = problem.series.iter().flat_map(|s| &s.input);
    let largest = inputs.fold(0.0f64, |m, u| m.max(u.abs()));
    let limit = problem.recording.model.input_limit;
    largest.min(limit.unwrap_or(f64::INFINITY))
}

/// The setting of the trials. The device starts at rest in the middle of the recorded positions, or where a spring or gravity holds it.
fn setting(problem: &Problem<'_>) -> Setting {
    let model = &problem.recording.model;
    let [low, high] = problem.extremes();
    let rest = if model.stiffness > 0.0 {
        model.stiffness_zero
    } else if model.gravity > 0.0 {
        model.gravity_zero
    } else {
        0.5 * (low + high)
    };
    let margin = MARGIN * (high - low);
    let clocks = problem
        .series
        .iter()
        .filter_map(|s| Some(s.session(s.time.len().checked_sub(1)?)));
    Setting {
        start_s: clocks.fold(0.0, f64::max) + problem.recording.horizon,
        rest,
        range: model.travel.unwrap_or([low - margin, high + margin]),
        tick_s: problem.recording.horizon / TICKS,
    }
}

/// The settings of an excitation that apply to its shape.
fn settings(excitation: &Excitation) -> BTreeMap<&'static str, f64> {
    // The shortest decimal that gives the same `f32`.
    let decimal = |x: f32| x.to_string().parse().unwrap_or(f64::from(x));
    let mut settings = BTreeMap::from([
        ("amplitude", decimal(excitation.amplitude)),
        ("duration_s", decimal(excitation.duration_s)),
    ]);
    if !matches!(excitation.shape, Shape::Step | Shape::Ramp) {
        settings.insert("frequency_hz", decimal(excitation.frequency_hz));
    }
    if excitation.shape == Shape::Chirp {
        settings.insert("end_frequency_hz", decimal(excitation.end_frequency_hz));
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Fit;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::floor::{ExpectedLoss, WHITE};
    use crate::made;
    use crate::select::{Acceptance, Round};
    use crate::term::{Coordinate, Scale, Term};
    use host_sim::effects::Effect;
    use recording::{Drive, Model, Recording, Run};

    const LARGEST_INPUT: f64 = 0.001;

    /// A recording of a paddle with small motion.
    fn recording() -> Recording {
        let model = Model {
            coulomb: 0.004,
            stiffness: 0.03,
            ratio: 15.0,
            travel: Some([-0.6, 0.6]),
            ..Model::new(5.755e-4)
        };
        let mut recording = Recording::new("made for a test", 0.3, model);
        let time: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-3).collect();
        let input = time
            .iter()
            .map(|t| LARGEST_INPUT * (9.0 * t).sin())
            .collect();
        let position = time.iter().map(|t| 0.2 * (9.0 * t).sin()).collect();
        let run = Run::new("run.csv", Drive::OpenLoop, time, input, position);
        recording.runs.push(run);
        recording
    }

    /// A fit without or with one effect, with the same cost in each of ten windows.
    fn fit(effect: Option<&str>, cost: f64) -> Fit {
        let effect = effect.map(|text| text.parse::<Effect>().unwrap());
        let terms = effect.map(|effect| Term {
            kind: effect.kind,
            values: effect.values,
            free: Vec::new(),
            sensor_on_load: false,
        });
        Fit {
            hypothesis: Hypothesis {
                terms: terms.into_iter().collect(),
            },
            x: Vec::new(),
            std: Vec::new(),
            costs: Costs {
                per_sample: vec![cost; 10],
                prior: 0.0,
            },
        }
    }

    fn round(rivals: &[(&'static str, f64)]) -> Round {
        let rivals = rivals.iter().map(|(effect, cost)| Rival {
            name: effect.split(':').next().unwrap(),
            fit: fit(Some(effect), *cost),
        });
        let rivals: Vec<Rival> = rivals.collect();
        Round {
            known: fit(None, 9.0),
            so_far: rivals[0].fit.clone(),
            rivals,
            screened: Vec::new(),
            acceptance: Acceptance::given(false),
            measured: None,
        }
    }

    fn next(rounds: Vec<Round>, last: Option<Round>, has_no_gap: bool) -> Option<NextExperiment> {
        separating(
            &made::problem(&recording()),
            &selection(rounds, last, has_no_gap),
        )
    }

    fn selection(rounds: Vec<Round>, last: Option<Round>, has_no_gap: bool) -> Selection {
        let null = fit(None, 9.0);
        let expected = ExpectedLoss {
            level: WHITE,
            error: 0.0,
            worst: 0.0,
        };
        Selection {
            has_no_gap,
            is_unambiguous: false,
            given: false,
            proposed: Vec::new(),
            null,
            expected,
            rounds,
            last,
        }
    }

    const STATIC: &str = "stribeck:static_ratio=1.5,velocity=0.1";
    const ELASTIC: &str = "presliding:distance=0.01,damping=0.02";

    #[test]
    fn tied_rivals_are_separated_within_the_recorded_input() {
        let next = next(vec![round(&[(STATIC, 1.0), (ELASTIC, 1.0)])], None, false).unwrap();
        assert_eq!(next.separates, ["stribeck", "presliding"]);
        assert!(next.difference_over_noise > 1.0, "{next:?}");
        assert!(next.settings["amplitude"] <= LARGEST_INPUT, "{next:?}");
    }

    #[test]
    fn without_undecided_rivals_no_experiment_is_proposed() {
        assert_eq!(
            next(vec![round(&[(STATIC, 1.0), (ELASTIC, 5.0)])], None, false),
            None
        );
        assert_eq!(
            next(vec![], Some(round(&[(STATIC, 1.0), (ELASTIC, 1.0)])), true),
            None
        );
    }

    #[test]
    fn for_an_unexplained_gap_the_two_best_rivals_are_separated() {
        let last = round(&[(STATIC, 5.0), (ELASTIC, 6.0), ("viscous", 7.0)]);
        let next = next(vec![], Some(last), false).unwrap();
        assert_eq!(next.separates, ["stribeck", "presliding"]);
    }

    #[test]
    fn a_difference_that_a_free_parameter_can_compensate_separates_nothing() {
        let recording = made::recording(&["spring:stiffness=0.06,zero=0"]);
        let problem = made::problem(&recording);
        let free = Coordinate {
            parameter: 0,
            start: 0.06,
            scale: Scale::Log,
        };
        let hypothesis = Hypothesis {
            terms: vec![made::term("spring", &[free])],
        };
        let best = problem.fit(&hypothesis, vec![0.0], Part::All, 5);
        // The fit with its parameter moved by `by`, either free or fixed.
        let other = |by: f64, free: bool| {
            let mut fit = best.clone();
            fit.x[0] += by;
            if !free {
                fit.hypothesis.terms[0] = fit.last_term().unwrap();
                fit.hypothesis.terms[0].free.clear();
                (fit.x, fit.std) = (Vec::new(), Vec::new());
            }
            fit
        };
        for (free, separates) in [(true, false), (false, true)] {
            let mut tied = round(&[(STATIC, 1.0), (ELASTIC, 1.0)]);
            tied.rivals[0].fit = other(0.0, free);
            tied.rivals[1].fit = other(0.002, free);
            for rival in &mut tied.rivals {
                rival.fit.costs = fit(None, 1.0).costs;
            }
            let next = separating(&problem, &selection(vec![tied], None, false));
            assert_eq!(next.is_some(), separates, "{next:?}");
        }
    }
}
