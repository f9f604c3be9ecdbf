//! Compares two sensors of one position: whether they disagree, which effect explains the disagreement, and with which of them the
//! dynamics agree.
//!
//! The comparison does not show an error that both sensors share, such as backlash before both of them. The recording format requires
//! that each column is an independent sensor.

mod sensor_fit;
mod two;

use crate::columns::{self, Columns, disagreement, mean_square, residuals};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::objective::Objective;
use crate::fit::part;
use crate::fit::problem::Problem;
use crate::floor::mean_and_error;
use crate::shrink::{resampled, shrink};
use crate::term::{Coordinate, Scale, Term};
use crate::windows::series::Series;
use host_sim::effects::Kind;
use recording::Recording;
use sensor_fit::{SensorFit, sensor_fits};
use two::{Part, two};

/// Two columns agree if no effect reduces their squared difference by more than this share of the noise variance.
const AGREEMENT: f64 = 0.1;
/// Significance of a disagreement within the noise, in standard errors. Below it the columns agree.
const LEAST_SIGNIFICANCE: f64 = 4.0;
/// Largest squared difference of columns that agree, over the noise variance. The variance is known to about 15 %, and quantization
/// correlates the noise.
const MOST_NOISE: f64 = 2.0;
/// Largest share of the squared disagreement beyond noise that the effect may leave.
const MOST_LEFT: f64 = 0.1;
/// Share of the squared gap that must disappear with the other column instead of `position` for the other column to be right. Other
/// errors of the nominal model may compensate a part.
const DECISIVE_FOR_OTHER: f64 = 0.5;
/// Share of the squared gap that must disappear with `position` for `position` to be right. Together with a larger effect of the device,
/// a wrong `position` may fit better than a right one.
const DECISIVE_FOR_POSITION: f64 = 0.9;
/// Scale of the coordinates in a fit of the effect, as a share of each value.
const RELATIVE_SCALE: f64 = 0.01;
/// Noise share by which the squared residual of another effect may exceed that of the best for the two to be inseparable.
const TIE: f64 = 0.1;

/// The result of comparing `position` with another column.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    /// The other column.
    pub column: String,
    /// Rms of the disagreement without its mean, in position units.
    pub before: f64,
    /// Rms disagreement that noise alone causes, in position units.
    pub floor: f64,
    pub outcome: Outcome,
    /// Share of the squared gap that disappears if the other column is predicted, with its 95 % interval.
    pub share: [f64; 3],
}

#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    /// The columns agree within noise.
    Agree,
    /// `position` has an effect relative to the other column, and the dynamics agree with the other column.
    PositionWrong(Match),
    /// `position` has an effect relative to the other column, and the dynamics do not show which column is wrong.
    Undecided(Match),
    /// The dynamics agree with `position`.
    OtherWrong,
    /// Two effects together, of the named column, explain the disagreement.
    LikeTwo(String, [Part; 2]),
    /// No effect explains the disagreement.
    Unlike,
}

/// The effect by which `position` differs from the other column.
#[derive(Clone, Debug)]
pub(crate) struct Match {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
    /// Shrink of the rms disagreement, with its 95 % interval.
    pub shrink: [f64; 3],
    /// Names of effects that explain the disagreement as well.
    pub ties: Vec<&'static str>,
    /// True if the effect leaves only noise.
    pub is_all: bool,
}

impl Match {
    /// The effect as a term whose values may change slightly, because the smoothing of a column biases them.
    pub(crate) fn term(&self) -> Term {
        let movable = |i: &usize| {
            // Instants are fixed.
            let is_instant = self.kind.is_event(&self.values) && i.is_multiple_of(2);
            self.values[*i] != 0.0 && !is_instant
        };
        let free = (0..self.values.len()).filter(movable);
        let coordinate = |i: usize| Coordinate {
            parameter: i,
            start: self.values[i],
            scale: Scale::Linear(RELATIVE_SCALE * self.values[i].abs()),
        };
        Term {
            kind: self.kind,
            values: self.values.clone(),
            free: free.map(coordinate).collect(),
            sensor_on_load: false,
        }
    }

    /// Instants at which the effect occurs, s of the session. It is empty for a permanent effect.
    fn instants_s(&self) -> Vec<f64> {
        if !self.kind.is_event(&self.values) {
            return Vec::new();
        }
        let instants = (0..).map_while(|i| self.values.get(self.kind.event_place(i)));
        instants.copied().collect()
    }
}

impl Comparison {
    /// The effect by which the columns differ, unless the other column is wrong.
    pub(crate) fn like(&self) -> Option<&Match> {
        match &self.outcome {
            Outcome::PositionWrong(like) | Outcome::Undecided(like) => Some(like),
            Outcome::Agree | Outcome::OtherWrong | Outcome::LikeTwo(..) | Outcome::Unlike => None,
        }
    }

    /// True if the dynamics show that `position` is wrong.
    pub(crate) fn is_certain(&self) -> bool {
        matches!(self.outcome, Outcome::PositionWrong(_))
    }

    /// Sensing effects that `position` does not have.
    pub(crate) fn excluded(&self) -> Vec<&'static str> {
        let like = self.like().map(|like| like.kind.name);
        let all = effects::sensing().map(|effect| effect.name());
        match &self.outcome {
            // Several of them may be present.
            Outcome::LikeTwo(..) | Outcome::Unlike => Vec::new(),
            _ if self.like().is_some_and(|like| !like.is_all) => Vec::new(),
            _ => all.filter(|name| Some(*name) != like).collect(),
        }
    }

    /// The result in one line, or `None` if the columns agree.
    pub(crate) fn line(&self, unit: &str) -> Option<String> {
        let Self {
            column,
            before,
            floor,
            ..
        } = self;
        let how = match &self.outcome {
            Outcome::Agree => return None,
            Outcome::PositionWrong(like) => {
                format!(
                    "like {} of position, and the motion fits {column}",
                    like.kind.name
                )
            }
            Outcome::Undecided(like) => format!(
                "like {} of position, but the motion does not show which column is right",
                like.kind.name
            ),
            Outcome::OtherWrong => format!("and the motion fits position: repair {column}"),
            Outcome::LikeTwo(wrong, [first, second]) => {
                format!("like {first} and {second} of {wrong} together")
            }
            Outcome::Unlike => "and no sensing effect and no pair of them explains it".to_owned(),
        };
        Some(format!(
            "position and {column} disagree by {before:.3e} {unit} rms, of which noise explains {floor:.1e}, {how}"
        ))
    }
}

/// Compares `position` with each other column, and returns the most informative comparison.
pub(crate) fn compare(
    problem: &Problem<'_>,
    coarse: impl Fn(&Recording) -> Vec<Series>,
) -> Option<Comparison> {
    let mut names: Vec<&String> = problem
        .recording
        .runs
        .iter()
        .flat_map(|run| run.positions.keys())
        .collect();
    names.sort();
    names.dedup();
    let all = names
        .into_iter()
        .filter_map(|column| compared(problem, column, &coarse));
    all.min_by_key(|comparison| match comparison.outcome {
        Outcome::Agree => 0,
        Outcome::PositionWrong(_) => 1,
        Outcome::Undecided(_) => 2,
        Outcome::OtherWrong => 3,
        Outcome::LikeTwo(..) => 4,
        Outcome::Unlike => 5,
    })
}

fn compared(
    problem: &Problem<'_>,
    column: &str,
    coarse: impl Fn(&Recording) -> Vec<Series>,
) -> Option<Comparison> {
    let recording = problem.recording;
    let both = columns::exchanged(recording, column);
    let [own, other] = both.each_ref().map(|exchanged| {
        let mut series = coarse(exchanged);
        series.retain(|s| columns::is_live(&recording.runs[s.run], column));
        series
    });
    let quanta = ["position", column].map(|name| recording.sensor(name).resolution);
    let of = |reference: &[Series], shown: &[Series]| {
        Columns::of(reference, shown, recording.restart_half_width, quanta)
    };
    let columns = of(&other, &own);
    if columns.tracks.is_empty() {
        return None;
    }
    let difference = disagreement(&columns.tracks);
    let before = mean_square(&difference);
    let like = best_match(&columns, &difference);
    let whole = share(problem, &both, [own.clone(), other.clone()]);
    let instants_s = like.as_ref().map_or(Vec::new(), Match::instants_s);
    let share = if instants_s.is_empty() {
        whole
    } else {
        // A device does not jump, whatever errors the model has.
        share_less(&[&own, &other].map(|column| jump_squares(column, &instants_s)))
    };
    let outcome = match like {
        None if before < MOST_NOISE * columns.variance => Outcome::Agree,
        Some(like) if share[0] > DECISIVE_FOR_OTHER && share[1] > 0.0 => {
            Outcome::PositionWrong(like)
        }
        Some(_) if share[0] < -DECISIVE_FOR_POSITION && share[2] < 0.0 => Outcome::OtherWrong,
        Some(like) => Outcome::Undecided(like),
        None => {
            // The other column may have a lag or play, which `position` cannot precede.
            let exchanged_columns = of(&own, &other);
            match best_match(&exchanged_columns, &disagreement(&exchanged_columns.tracks)) {
                Some(_) if share[0] <= DECISIVE_FOR_OTHER => Outcome::OtherWrong,
                _ => like_two(
                    [("position", &columns), (column, &exchanged_columns)],
                    before,
                ),
            }
        }
    };
    Some(Comparison {
        column: column.to_owned(),
        before: before.sqrt(),
        floor: columns.variance.sqrt(),
        outcome,
        share: whole,
    })
}

/// Two effects that together explain the disagreement as errors of one column, if they leave little beyond noise.
fn like_two(of: [(&str, &Columns); 2], disagreement: f64) -> Outcome {
    let found = of.into_iter().find_map(|(wrong, columns)| {
        let (parts, left) = two(columns)?;
        let [before, after] = [disagreement, left].map(|square| square - columns.variance);
        (after <= MOST_LEFT * before).then(|| Outcome::LikeTwo(wrong.to_owned(), parts))
    });
    found.unwrap_or(Outcome::Unlike)
}

/// The effect that converts the reference column into the shown one, if there is one.
fn best_match(columns: &Columns, difference: &[f64]) -> Option<Match> {
    let mut all = sensor_fits(columns).into_iter();
    let best = all.next()?;
    let disagreement = mean_square(difference);
    let closed = disagreement - best.left;
    if closed < AGREEMENT * columns.variance
        || best.left - columns.variance > MOST_LEFT * (disagreement - columns.variance)
    {
        return None;
    }
    let left = residuals(&columns.tracks, best.kind, &best.values);
    let [before, after] = [difference, &left].map(|r| window_squares(columns, r));
    let gains: Vec<f64> = before.iter().zip(&after).map(|(b, a)| b - a).collect();
    let (gain, error) = mean_and_error(&gains);
    // A disagreement far above noise is significant even in few windows. Jumps may cancel in the mean, so they need no significance
    // either.
    let is_faint = disagreement < MOST_NOISE * columns.variance;
    let is_jump = best.kind.is_event(&best.values);
    if is_faint && gain < LEAST_SIGNIFICANCE * error && !is_jump {
        return None;
    }
    let floor: Vec<f64> = windows(columns)
        .map(|window| columns.variance * window as f64)
        .collect();
    let close = best.left + TIE * columns.variance;
    let tied = |other: &SensorFit| other.left <= close && other.kind.name != best.kind.name;
    let mut ties: Vec<&'static str> = all.filter(tied).map(|other| other.kind.name).collect();
    ties.dedup();
    // A sensor curve without curvature is a gain, so it is no separate tie.
    ties.retain(|name| !effects::of(name).contains(best.kind.name));
    Some(Match {
        shrink: shrink(&before, &after, &floor, &before),
        kind: best.kind,
        values: best.values,
        ties,
        is_all: best.left < MOST_NOISE * columns.variance,
    })
}

/// Number of samples of each window.
fn windows(columns: &Columns) -> impl Iterator<Item = usize> {
    let tracks = columns.tracks.iter();
    tracks.flat_map(|track| track.windows.iter().map(std::ops::Range::len))
}

/// Sum of squares of each window.
fn window_squares(columns: &Columns, residuals: &[f64]) -> Vec<f64> {
    let mut remaining = residuals;
    let squares = windows(columns).map(|samples| {
        let (in_window, others) = remaining.split_at(samples.min(remaining.len()));
        remaining = others;
        in_window.iter().map(|r| r * r).sum()
    });
    squares.collect()
}

/// Share of the squared gap of the nominal model beyond noise that disappears if the other column is predicted. It is 0 if the column
/// with the smaller gap beyond its floor has the larger gap in all: the floor of a noisy column may hide a gap.
fn share(problem: &Problem<'_>, both: &[Recording; 2], series: [Vec<Series>; 2]) -> [f64; 3] {
    let bare = Hypothesis { terms: Vec::new() };
    let left = |series: Vec<Series>, recording: &Recording| {
        let problem = Problem {
            recording,
            series,
            priors: problem.priors.clone(),
            modelling: 0.0,
            objective: Objective::Robust,
            quarter: None,
        };
        let x = vec![0.0; bare.dimensions(&problem.priors)];
        let fit = Fit {
            costs: problem.costs(&bare, &x, part::Part::All),
            std: vec![0.0; x.len()],
            hypothesis: bare.clone(),
            x,
        };
        let squares = problem.window_squares(&fit, part::Part::All);
        let floor = problem.floor_squares(&fit);
        let beyond = squares.iter().zip(floor).map(|(s, f)| s - f);
        let beyond: Vec<f64> = beyond.collect();
        (squares.iter().sum::<f64>(), beyond)
    };
    let [position, other] = series;
    let (position_left, position) = left(position, &both[0]);
    let (other_left, other) = left(other, &both[1]);
    let share = share_less(&[position, other]);
    match share[0] * (position_left - other_left) < 0.0 {
        true => [0.0; 3],
        false => share,
    }
}

/// Share by which the squares of the second column are smaller than those of the first, with its 95 % interval.
fn share_less(columns: &[Vec<f64>; 2]) -> [f64; 3] {
    resampled(columns[0].len(), |sum| {
        let [before, after] = columns.each_ref().map(|squares| sum(squares).max(0.0));
        ((before - after) / before.max(after).max(f64::MIN_POSITIVE)).min(1.0)
    })
}

/// Number of steps across a jump, and before and after it. The samples next to the jump may be averages across it.
const ACROSS: usize = 3;

/// Squared change of a column at each of some instants, less the mean change directly before and after.
fn jump_squares(column: &[Series], instants_s: &[f64]) -> Vec<f64> {
    let jump = |at_s: &f64| {
        let within = |series: &&Series| {
            let span = series.session_span_s();
            span.is_some_and(|[from, to]| (from..=to).contains(at_s))
        };
        let series = column.iter().find(within)?;
        let after = (0..series.time.len()).position(|i| series.session(i) >= *at_s)?;
        let from = after.checked_sub(ACROSS + ACROSS / 2 + 1)?;
        let around = series.position.get(from..=from + 3 * ACROSS)?;
        let change = |part: usize| around[(part + 1) * ACROSS] - around[part * ACROSS];
        Some((change(1) - 0.5 * (change(0) + change(2))).powi(2))
    };
    instants_s
        .iter()
        .map(|at_s| jump(at_s).unwrap_or(0.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::windows::series;
    use host_sim::device::Device;
    use host_sim::effects::Effect;
    use host_sim::plant::Plant;
    use host_sim::sensing::Reading;
    use host_sim::sensors::Noise;
    use recording::{Drive, Model, Run, Sensor};

    /// Names of all sensing effects.
    fn sensing() -> Vec<&'static str> {
        effects::sensing().map(|effect| effect.name()).collect()
    }

    const PERIOD_S: f64 = 1e-3;
    const SAMPLES: usize = 8000;
    const NOISE: [f64; 2] = [1e-4, 3e-4];

    /// The comparison for a paddle with the effect `mechanics` and two sensors, each with an effect of its own.
    fn compared(mechanics: &str, position: &str, other: &str) -> Comparison {
        let model = Model {
            viscous: 1e-3,
            stiffness: 0.03,
            ratio: 15.0,
            ..Model::new(5.755e-4)
        };
        let [real, position, other] = [mechanics, position, other].map(|effect| {
            let mut device = Device::nominal(&model);
            if !effect.is_empty() {
                effect.parse::<Effect>().unwrap().install(&mut device);
            }
            device
        });
        let plant = Plant::new(real.mechanics.clone());
        let mut state = plant.state(0.0, 0.0, 0.0);
        let sensing = [position.sensing, other.sensing];
        let mut readings = sensing.each_ref().map(|s| Reading::at_rest(s, 0.0));
        let mut noise = Noise::new(7);
        let (mut time, mut input) = (vec![], vec![]);
        let mut columns = [vec![], vec![]];
        for i in 0..SAMPLES {
            let t = i as f64 * PERIOD_S;
            let u = 0.0011 * (9.0 * t).sin() + 0.0008 * (4.3 * t).cos();
            time.push(t);
            input.push(u);
            for k in 0..2 {
                let x = plant.seen(&state).0;
                let y = readings[k].follow(&sensing[k], x, if i > 0 { PERIOD_S } else { 0.0 });
                columns[k].push(y + sensing[k].jumped(t) + noise.next(NOISE[k]));
            }
            let torque = host_sim::plant::Torque::held(15.0 * u);
            plant.advance(&mut state, torque, PERIOD_S);
        }
        let mut recording = Recording::new("made for a test", 0.3, model);
        let [position, other] = columns;
        let mut run = Run::new("run.csv", Drive::OpenLoop, time, input, position);
        run.positions.insert("position_hall".into(), other);
        recording.runs.push(run);
        for (name, noise) in ["position", "position_hall"].into_iter().zip(NOISE) {
            let sensor = Sensor {
                noise,
                ..Sensor::default()
            };
            recording.sensors.insert(name.into(), sensor);
        }
        let coarse = |own: &Recording| series::coarse(own, own.horizon);
        compare(&made::problem(&recording), coarse).unwrap()
    }

    /// The effect of `position`, which must be found wrong.
    fn wrong_position(mechanics: &str, position: &str) -> Match {
        match compared(mechanics, position, "").outcome {
            Outcome::PositionWrong(found) => found,
            other => panic!("{position}: {other:?}"),
        }
    }

    #[test]
    fn equal_sensors_agree_and_exclude_all_sensing_effects() {
        let comparison = compared("viscous:coefficient=0.004", "", "");
        assert!(
            matches!(comparison.outcome, Outcome::Agree),
            "{comparison:?}"
        );
        assert_eq!(comparison.excluded(), sensing());
    }

    #[test]
    fn each_sensing_effect_is_identified_from_two_columns() {
        for (effect, parameter, tolerance) in [
            ("sensor_gain:gain=1.1", 0, 0.002),
            ("sensor_nonlinearity:quadratic=0.3", 0, 0.02),
            ("sensor_hysteresis:width=0.01", 0, 0.05),
            ("sensor_hysteresis:width=0.01,reach=0.03", 0, 0.05),
            ("sensor_lag:time=0.006", 0, 0.03),
            ("lost_counts:jump=0,share=0.2,speed=2", 2, 0.03),
        ] {
            let found = wrong_position("", effect);
            let hidden: Effect = effect.parse().unwrap();
            assert_eq!(found.kind.name, hidden.kind.name);
            let error = (found.values[parameter] / hidden.values[parameter] - 1.0).abs();
            assert!(error < tolerance, "{effect}: {found:?}");
            assert!(found.shrink[0] > 0.9, "{effect}: {found:?}");
        }
    }

    #[test]
    fn a_gain_and_a_hysteresis_are_found_together() {
        let comparison = compared("", "sensor_gain:gain=1.03", "sensor_hysteresis:width=0.02");
        let Outcome::LikeTwo(_, parts) = &comparison.outcome else {
            panic!("{:?}", comparison.outcome);
        };
        let mut names = parts.each_ref().map(|part| part.kind.name);
        names.sort_unstable();
        assert_eq!(names, ["sensor_gain", "sensor_hysteresis"]);
        let line = comparison.line("rad").expect("a line");
        assert!(line.contains("together"), "{line}");
    }

    #[test]
    fn a_jump_is_found_with_its_instant_and_height() {
        let comparison = compared("", "lost_counts:time=3.2,jump=0.04", "");
        let found = comparison.like().unwrap();
        assert_eq!(found.kind.name, "lost_counts");
        assert_eq!(found.values[2..], [0.0; 2]);
        assert!((found.values[0] - 3.2).abs() < PERIOD_S && (found.values[1] - 0.04).abs() < 0.002);
    }

    #[test]
    fn a_jump_shows_the_wrong_column_even_with_a_wrong_model() {
        let jump = "lost_counts:time=3.2,jump=0.04";
        assert_eq!(
            wrong_position("viscous:coefficient=0.004", jump).kind.name,
            "lost_counts"
        );
        let comparison = compared("viscous:coefficient=0.004", "", jump);
        assert!(
            matches!(comparison.outcome, Outcome::OtherWrong),
            "{comparison:?}"
        );
    }

    #[test]
    fn a_sensor_gain_that_compensates_friction_is_found() {
        // More friction makes the motion smaller, and the sensor gain makes it larger.
        let comparison = compared("viscous:coefficient=0.003", "sensor_gain:gain=1.2", "");
        assert_eq!(comparison.like().unwrap().kind.name, "sensor_gain");
    }

    #[test]
    fn errors_of_the_other_column_are_attributed_to_it() {
        for effect in [
            "sensor_gain:gain=1.1",
            "sensor_lag:time=0.01",
            "sensor_hysteresis:width=0.02",
        ] {
            let comparison = compared("", "", effect);
            assert!(
                matches!(comparison.outcome, Outcome::OtherWrong),
                "{effect}: {comparison:?}"
            );
            assert_eq!(comparison.excluded(), sensing());
        }
    }
}
