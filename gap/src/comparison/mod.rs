//! Two sensors of one position, compared: whether they disagree, like which effect, and which of them the dynamics
//! believe.
//!
//! What both share, such as play in a coupling before either of them, no comparison shows; the format has each column
//! be a sensor of its own.

mod likeness;
mod two;

use crate::columns::{self, Columns, disagreement, mean_square, residuals};
use crate::effects;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::fit::part;
use crate::fit::problem::Problem;
use crate::floor::mean_and_error;
use crate::shrink::{resampled, shrink};
use crate::term::{Coordinate, Scale, Term};
use crate::windows::series::Series;
use host_sim::effects::Kind;
use likeness::{Likeness, likenesses};
use recording::Recording;
use two::{Part, two};

/// Columns whose disagreement goes with no effect by more than this share of the noise, in squares, agree.
const AGREEMENT: f64 = 0.1;
/// So do those that disagree within the noise and by less than this many standard errors.
const LEAST_SIGNIFICANCE: f64 = 4.0;
/// And those that agree leave no more than this many times the noise, in squares: it is known to some 15 %, and coloured
/// by quantising.
const MOST_NOISE: f64 = 2.0;
/// A likeness leaves at most this share of the disagreement beyond noise, in squares.
const MOST_LEFT: f64 = 0.1;
/// The other column is right for sure if predicting it instead of `position` takes this share of the gap away, in squares: what
/// else the nominal model misses may make up for a part.
const DECISIVE: f64 = 0.5;
/// And `position` is if predicting it takes this share away. Beside a larger effect of the device a wrong `position` may fit
/// better than a right one: of 592 blind recordings two did, by 0.51 and 0.76.
const DECISIVE_FOR_POSITION: f64 = 0.9;
/// A fifth of the share by which a value may move in a fit.
const MOVE: f64 = 0.01;
/// Another is not separable if it leaves no more than this share of the noise beyond the likeliest, in squares.
const TIE: f64 = 0.1;

/// What comparing `position` with another column says.
#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    /// The other column.
    pub column: String,
    /// Root mean square of the disagreement, zeros apart, in units of position.
    pub before: f64,
    /// What noise alone makes of that.
    pub floor: f64,
    pub outcome: Outcome,
    /// Share of the gap, in squares, that is not there if the other column is predicted, with its 95 % interval.
    pub share: [f64; 3],
}

#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    /// Within noise.
    Agree,
    /// `position` shows the other column as an effect would, and the dynamics believe the other column.
    PositionWrong(Match),
    /// The same, but the dynamics do not say which column is wrong.
    Undecided(Match),
    /// The dynamics believe `position`.
    OtherWrong,
    /// Like two effects together, of the column of that name.
    LikeTwo(String, [Part; 2]),
    /// Like no effect.
    Unlike,
}

/// The effect by which `position` differs from the other column.
#[derive(Clone, Debug)]
pub(crate) struct Match {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
    /// Of the rms disagreement, with its 95 % interval.
    pub shrink: [f64; 3],
    /// Names that make the columns differ alike.
    pub ties: Vec<&'static str>,
    /// True if it leaves nothing but noise.
    pub is_all: bool,
}

impl Match {
    /// As a term whose values may move a little: predictions are off by what the smoothing of a column costs.
    pub(crate) fn term(&self) -> Term {
        let movable = |i: &usize| {
            // Instants stay.
            let is_instant = self.kind.is_event(&self.values) && i.is_multiple_of(2);
            self.values[*i] != 0.0 && !is_instant
        };
        let free = (0..self.values.len()).filter(movable);
        let coordinate = |i: usize| Coordinate {
            parameter: i,
            start: self.values[i],
            scale: Scale::Linear(MOVE * self.values[i].abs()),
        };
        Term {
            kind: self.kind,
            values: self.values.clone(),
            free: free.map(coordinate).collect(),
            sensor_on_load: false,
        }
    }

    /// The moments of the session in which it happens; none of what is there all the time.
    fn moments_s(&self) -> Vec<f64> {
        if !self.kind.is_event(&self.values) {
            return Vec::new();
        }
        let instants = (0..).map_while(|i| self.values.get(self.kind.event_place(i)));
        instants.copied().collect()
    }
}

impl Comparison {
    /// The effect by which the columns differ, unless it is the other column that is wrong.
    pub(crate) fn like(&self) -> Option<&Match> {
        match &self.outcome {
            Outcome::PositionWrong(like) | Outcome::Undecided(like) => Some(like),
            Outcome::Agree | Outcome::OtherWrong | Outcome::LikeTwo(..) | Outcome::Unlike => None,
        }
    }

    /// True if the dynamics say that it is `position` that is wrong.
    pub(crate) fn is_certain(&self) -> bool {
        matches!(self.outcome, Outcome::PositionWrong(_))
    }

    /// Effects of `position` that are known not to be there.
    pub(crate) fn excluded(&self) -> Vec<&'static str> {
        let like = self.like().map(|like| like.kind.name);
        let all = effects::sensing().map(|effect| effect.name());
        match &self.outcome {
            // More than one of them may be there.
            Outcome::LikeTwo(..) | Outcome::Unlike => Vec::new(),
            _ if self.like().is_some_and(|like| !like.is_all) => Vec::new(),
            _ => all.filter(|name| Some(*name) != like).collect(),
        }
    }

    /// One line for the reader.
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
                "like {} of position, but the motion does not say which of them is right",
                like.kind.name
            ),
            Outcome::OtherWrong => format!("and the motion fits position: mend {column}"),
            Outcome::LikeTwo(wrong, [first, second]) => {
                format!("like {first} and {second} of {wrong} together")
            }
            Outcome::Unlike => "like no sensing effect and no two of them".to_owned(),
        };
        Some(format!(
            "position and {column} disagree by {before:.3e} {unit} rms, where noise makes {floor:.1e}, {how}"
        ))
    }
}

/// Compares `position` with each other column; the one that says most of `position` counts.
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
    let like = likely(&columns, &difference);
    let whole = share(problem, &both, [own.clone(), other.clone()]);
    let moments_s = like.as_ref().map_or(Vec::new(), Match::moments_s);
    let share = if moments_s.is_empty() {
        whole
    } else {
        // A device does not jump, whatever else the model misses of it.
        less_by(&[&own, &other].map(|column| jumps(column, &moments_s)))
    };
    let outcome = match like {
        None if before < MOST_NOISE * columns.variance => Outcome::Agree,
        Some(like) if share[0] > DECISIVE && share[1] > 0.0 => Outcome::PositionWrong(like),
        Some(_) if share[0] < -DECISIVE_FOR_POSITION && share[2] < 0.0 => Outcome::OtherWrong,
        Some(like) => Outcome::Undecided(like),
        None => {
            // The other column may lag or have play where `position` cannot lead.
            let turned = of(&own, &other);
            match likely(&turned, &disagreement(&turned.tracks)) {
                Some(_) if share[0] <= DECISIVE => Outcome::OtherWrong,
                _ => like_two([("position", &columns), (column, &turned)], before),
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

/// Two effects that turn one column into the other, of the first column of which they leave little beyond noise.
fn like_two(of: [(&str, &Columns); 2], disagreement: f64) -> Outcome {
    let found = of.into_iter().find_map(|(wrong, columns)| {
        let (parts, left) = two(columns)?;
        let [before, after] = [disagreement, left].map(|square| square - columns.variance);
        (after <= MOST_LEFT * before).then(|| Outcome::LikeTwo(wrong.to_owned(), parts))
    });
    found.unwrap_or(Outcome::Unlike)
}

/// The effect that turns the reference into what is shown, if one does.
fn likely(columns: &Columns, difference: &[f64]) -> Option<Match> {
    let mut all = likenesses(columns).into_iter();
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
    // Far more than noise is no chance however few the windows, nor are jumps that cancel in the mean.
    let is_faint = disagreement < MOST_NOISE * columns.variance;
    let jumps = best.kind.is_event(&best.values);
    if is_faint && gain < LEAST_SIGNIFICANCE * error && !jumps {
        return None;
    }
    let floor: Vec<f64> = windows(columns)
        .map(|window| columns.variance * window as f64)
        .collect();
    let close = best.left + TIE * columns.variance;
    let tied = |other: &Likeness| other.left <= close && other.kind.name != best.kind.name;
    let mut ties: Vec<&'static str> = all.filter(tied).map(|other| other.kind.name).collect();
    ties.dedup();
    // A curve that is bent by nothing is a gain.
    ties.retain(|name| !effects::of(name).contains(best.kind.name));
    Some(Match {
        shrink: shrink(&before, &after, &floor, &before),
        kind: best.kind,
        values: best.values,
        ties,
        is_all: best.left < MOST_NOISE * columns.variance,
    })
}

/// Samples of each window.
fn windows(columns: &Columns) -> impl Iterator<Item = usize> {
    let tracks = columns.tracks.iter();
    tracks.flat_map(|track| track.windows.iter().map(std::ops::Range::len))
}

/// Sum of squares of each window.
fn window_squares(columns: &Columns, residuals: &[f64]) -> Vec<f64> {
    let mut rest = residuals;
    let squares = windows(columns).map(|samples| {
        let (mine, others) = rest.split_at(samples.min(rest.len()));
        rest = others;
        mine.iter().map(|r| r * r).sum()
    });
    squares.collect()
}

/// Share of the nominal model's squared gap beyond noise that is not there if the other column is predicted; none where one
/// leaves less beyond its floor and more with it: a noisy column may hide a gap in its floor.
fn share(problem: &Problem<'_>, both: &[Recording; 2], series: [Vec<Series>; 2]) -> [f64; 3] {
    let bare = Hypothesis { terms: Vec::new() };
    let left = |series: Vec<Series>, recording: &Recording| {
        let problem = Problem {
            recording,
            series,
            priors: problem.priors.clone(),
            modelling: 0.0,
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
    let share = less_by(&[position, other]);
    match share[0] * (position_left - other_left) < 0.0 {
        true => [0.0; 3],
        false => share,
    }
}

/// Share by which the squares of the second of two columns are less than those of the first, with its 95 % interval.
fn less_by(columns: &[Vec<f64>; 2]) -> [f64; 3] {
    resampled(columns[0].len(), |sum| {
        let [before, after] = columns.each_ref().map(|squares| sum(squares).max(0.0));
        ((before - after) / before.max(after).max(f64::MIN_POSITIVE)).min(1.0)
    })
}

/// Samples across a jump, as many as before and after it: one that is a mean may be of both.
const ACROSS: usize = 3;

/// Square of what a column goes at each of some moments of the session beyond what it goes right before and after.
fn jumps(column: &[Series], moments_s: &[f64]) -> Vec<f64> {
    let jump = |at_s: &f64| {
        let within = |series: &&Series| {
            let span = series.session_span_s();
            span.is_some_and(|[from, to]| (from..=to).contains(at_s))
        };
        let series = column.iter().find(within)?;
        let after = (0..series.time.len()).position(|i| series.session(i) >= *at_s)?;
        let from = after.checked_sub(ACROSS + ACROSS / 2 + 1)?;
        let around = series.position.get(from..=from + 3 * ACROSS)?;
        let way = |part: usize| around[(part + 1) * ACROSS] - around[part * ACROSS];
        Some((way(1) - 0.5 * (way(0) + way(2))).powi(2))
    };
    moments_s
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

    /// A paddle with what is written in `mechanics`, seen by two sensors, each with what is written for it.
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

    /// The effect of `position` that was found for sure.
    fn blamed(mechanics: &str, position: &str) -> Match {
        match compared(mechanics, position, "").outcome {
            Outcome::PositionWrong(found) => found,
            other => panic!("{position}: {other:?}"),
        }
    }

    #[test]
    fn equal_sensors_clear_each_other() {
        let comparison = compared("viscous:coefficient=0.004", "", "");
        assert!(
            matches!(comparison.outcome, Outcome::Agree),
            "{comparison:?}"
        );
        assert_eq!(comparison.excluded(), sensing());
    }

    #[test]
    fn each_effect_is_known_by_how_the_columns_differ() {
        for (effect, parameter, tolerance) in [
            ("sensor_gain:gain=1.1", 0, 0.002),
            ("sensor_nonlinearity:quadratic=0.3", 0, 0.02),
            ("sensor_hysteresis:width=0.01", 0, 0.05),
            ("sensor_hysteresis:width=0.01,reach=0.03", 0, 0.05),
            ("sensor_lag:time=0.006", 0, 0.03),
            ("lost_counts:jump=0,share=0.2,speed=2", 2, 0.03),
        ] {
            let found = blamed("", effect);
            let hidden: Effect = effect.parse().unwrap();
            assert_eq!(found.kind.name, hidden.kind.name);
            let error = (found.values[parameter] / hidden.values[parameter] - 1.0).abs();
            assert!(error < tolerance, "{effect}: {found:?}");
            assert!(found.shrink[0] > 0.9, "{effect}: {found:?}");
        }
    }

    #[test]
    fn a_scale_and_play_of_one_column_are_told_together() {
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
    fn a_jump_is_found_where_it_is() {
        let comparison = compared("", "lost_counts:time=3.2,jump=0.04", "");
        let found = comparison.like().unwrap();
        assert_eq!(found.kind.name, "lost_counts");
        assert_eq!(found.values[2..], [0.0; 2]);
        assert!((found.values[0] - 3.2).abs() < PERIOD_S && (found.values[1] - 0.04).abs() < 0.002);
    }

    #[test]
    fn a_jump_shows_which_column_is_wrong_however_wrong_the_model() {
        let jump = "lost_counts:time=3.2,jump=0.04";
        assert_eq!(
            blamed("viscous:coefficient=0.004", jump).kind.name,
            "lost_counts"
        );
        let comparison = compared("viscous:coefficient=0.004", "", jump);
        assert!(
            matches!(comparison.outcome, Outcome::OtherWrong),
            "{comparison:?}"
        );
    }

    #[test]
    fn what_makes_up_for_an_error_does_not_hide_it() {
        // More friction makes the motion smaller, and the gain shows it larger again.
        let comparison = compared("viscous:coefficient=0.003", "sensor_gain:gain=1.2", "");
        assert_eq!(comparison.like().unwrap().kind.name, "sensor_gain");
    }

    #[test]
    fn the_other_column_is_blamed_for_its_own_errors() {
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
