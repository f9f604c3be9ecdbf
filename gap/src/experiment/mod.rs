//! The excitation of the firmware that would tell rival models apart best.

mod menu;
mod trial;

use crate::diagnosis::NextExperiment;
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::select::{Rival, Selection, ties};
use crate::windows::motion::rms;
use haptic_paddle::excitation::{Excitation, Shape};
use host_sim::device::Device;
use rayon::prelude::*;
use std::collections::BTreeMap;
use trial::{Setting, difference, readings};

/// Ticks in a horizon.
const TICKS: f64 = 250.0;
/// Rivals that are told apart at most.
const MOST_RIVALS: usize = 4;
/// By how much of its span on either side the positions of the recording may be left, where no travel is
/// stated.
const MARGIN: f64 = 0.5;

/// The best excitation for what the selection leaves open; `None` if nothing is, or if every excitation
/// would drive one of the rivals out of its travel.
pub(crate) fn separating(problem: &Problem<'_>, selection: &Selection) -> Option<NextExperiment> {
    let rivals = open(selection)?;
    let devices: Vec<Device> = rivals.iter().map(|r| device(problem, &r.fit)).collect();
    let setting = setting(problem);
    let largest_input = largest_input(problem);
    if largest_input <= 0.0 {
        return None;
    }
    let noises = problem.series.iter().flat_map(|s| &s.windows);
    let noise = rms(&noises.map(|w| w.noise).collect::<Vec<_>>());
    let excitations = menu::excitations(largest_input, problem.recording.horizon);
    let (excitation, separation) = excitations
        .into_par_iter()
        .filter_map(|e| Some((e, separation(&devices, &e, &setting)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(NextExperiment {
        kind: Shape::NAMED
            .iter()
            .find(|(_, shape)| *shape == excitation.shape)
            .map_or("", |(name, _)| name),
        separates: rivals.iter().map(|r| r.name).collect(),
        settings: settings(&excitation),
        difference_over_noise: separation / noise.max(f64::MIN_POSITIVE),
    })
}

/// The rivals between which the recording does not decide: a winner and its ties, of the last round that
/// has any, or the best two where none earned its place.
fn open(selection: &Selection) -> Option<Vec<&Rival>> {
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
    let unexplained = selection.rounds.is_empty() && !selection.quiet;
    let best = selection.last.as_ref()?.rivals.get(..2)?;
    unexplained.then(|| best.iter().collect())
}

fn device(problem: &Problem<'_>, fit: &Fit) -> Device {
    let model = &problem.recording.model;
    fit.hypothesis.device(model, &problem.nudges, &fit.x)
}

/// The smallest difference of the winner from a rival, in units of position; `None` if one of the devices
/// does not stay where it may be.
fn separation(devices: &[Device], excitation: &Excitation, at: &Setting) -> Option<f64> {
    let shown: Option<Vec<Vec<f64>>> = devices
        .iter()
        .map(|d| readings(d, excitation, at))
        .collect();
    let shown = shown?;
    let (winner, others) = shown.split_first()?;
    others
        .iter()
        .map(|other| difference(winner, other))
        .min_by(f64::total_cmp)
}

/// The largest input that was given, within the limit.
fn largest_input(problem: &Problem<'_>) -> f64 {
    let inputs = problem.series.iter().flat_map(|s| &s.input);
    let largest = inputs.fold(0.0f64, |m, u| m.max(u.abs()));
    let limit = problem.recording.model.input_limit;
    largest.min(limit.unwrap_or(f64::INFINITY))
}

/// From rest at the middle of what was recorded, or where a spring or gravity holds it.
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

/// The numbers of an excitation that have a meaning for its shape.
fn settings(excitation: &Excitation) -> BTreeMap<&'static str, f64> {
    // The shortest decimal that is this number, not the binary one behind it.
    let told = |x: f32| x.to_string().parse().unwrap_or(f64::from(x));
    let mut settings = BTreeMap::from([
        ("amplitude", told(excitation.amplitude)),
        ("duration_s", told(excitation.duration_s)),
    ]);
    if !matches!(excitation.shape, Shape::Step | Shape::Ramp) {
        settings.insert("frequency_hz", told(excitation.frequency_hz));
    }
    if excitation.shape == Shape::Chirp {
        settings.insert("end_frequency_hz", told(excitation.end_frequency_hz));
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::costs::Costs;
    use crate::fit::hypothesis::{Hypothesis, Term};
    use crate::floor::{Perfect, WHITE};
    use crate::made;
    use crate::select::{Place, Round};
    use host_sim::effects::Effect;
    use recording::{Drive, Model, Recording, Run};

    const LARGEST_INPUT: f64 = 0.001;

    /// A paddle that was moved a little.
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

    /// The null, or one effect, with the same cost in each of ten windows.
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
            place: Place::given(false),
        }
    }

    fn next(rounds: Vec<Round>, last: Option<Round>, quiet: bool) -> Option<NextExperiment> {
        let recording = recording();
        let problem = made::problem(&recording);
        let null = fit(None, 9.0);
        let perfect = Perfect {
            level: WHITE,
            error: 0.0,
            worst: 0.0,
        };
        let selection = Selection {
            quiet,
            plain: false,
            given: false,
            null,
            perfect,
            rounds,
            last,
        };
        separating(&problem, &selection)
    }

    const STATIC: &str = "stribeck:static_ratio=1.5,velocity=0.1";
    const ELASTIC: &str = "presliding:distance=0.01,damping=0.02";

    #[test]
    fn tied_rivals_are_separated_within_what_was_given() {
        let next = next(vec![round(&[(STATIC, 1.0), (ELASTIC, 1.0)])], None, false).unwrap();
        assert_eq!(next.separates, ["stribeck", "presliding"]);
        assert!(next.difference_over_noise > 1.0, "{next:?}");
        assert!(next.settings["amplitude"] <= LARGEST_INPUT, "{next:?}");
    }

    #[test]
    fn nothing_open_needs_no_experiment() {
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
    fn an_unexplained_gap_asks_between_the_two_best() {
        let last = round(&[(STATIC, 5.0), (ELASTIC, 6.0), ("viscous", 7.0)]);
        let next = next(vec![], Some(last), false).unwrap();
        assert_eq!(next.separates, ["stribeck", "presliding"]);
    }
}
