//! Where the gap lies, from the data alone.

mod bins;
mod evidence;
mod grown;
mod innovation;
mod level;
mod missing;
mod recurrence;
mod region;
mod spectrum;

use crate::comparison::{Comparison, Outcome};
use crate::diagnosis::{MeasuredBy, Region};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::windows::series::{MOST_SAMPLES, some_fine};
use evidence::Evidence;
use grown::grown;
use host_sim::effects::Channel;
use innovation::innovations;
use missing::missing;
use region::Told;

/// A share of the gap that is most of it: its place is told first.
const MOST: f64 = 0.5;
/// What a channel's even share would be: there are five, and every sample passes through each.
const ONE_CHANNEL: f64 = 0.2;
/// Axes along which the gap arises that are told.
const AXES: usize = 3;
/// How much more the surplus of where it has grown speaks for an axis than what speaks for one along which it arises: of 618
/// places on blind sets six more were among the first three then than if it were always told, of 1436 on others one more.
const GROWN_WEIGHT: f64 = 2.5;

/// Parts of the data that carry clearly more of the gap than their share of the samples, the most telling first: different
/// axes, then what else stands out on them; and the channel of sensing, if another sensor accuses it.
pub(crate) fn regions(
    problem: &Problem<'_>,
    null: &Fit,
    comparison: Option<&Comparison>,
) -> Vec<Region> {
    let mut all = along_axes(problem, null);
    if let Some(sensing) = comparison.and_then(sensing) {
        let place = if sensing.share_of_gap > MOST {
            0
        } else {
            all.len()
        };
        all.insert(place, sensing);
    }
    all
}

/// The channel of sensing, if another sensor's position is predicted better.
fn sensing(comparison: &Comparison) -> Option<Region> {
    let [share, low, high] = comparison.share;
    let disagrees = !matches!(comparison.outcome, Outcome::Agree);
    let region = Region {
        axis: "channel",
        from: None,
        to: None,
        name: Some(Channel::Sensing.name().to_owned()),
        run: None,
        share_of_gap: share,
        measured_by: MeasuredBy::SecondSensor,
        share_of_gap_interval: [low, high],
        share_of_samples: ONE_CHANNEL,
        profile: None,
    };
    (disagrees && region.is_clear()).then_some(region)
}

/// Axes, two of which tell where the gap arises and the third where it has come to be largest, unless another says much more
/// of where it arises, and what else stands out on them.
///
/// It arises along an axis of which a stretch carries more than its share, and of which the missing
/// acceleration is a function, beyond a constant and a level of friction. Motion couples the axes, so
/// that the next best ones are told too.
fn along_axes(problem: &Problem<'_>, null: &Fit) -> Vec<Region> {
    let recording = problem.recording;
    // Numbers that have gone to make up for the gap hide where it lies.
    let stated = null.is_strained().then(|| null.as_stated());
    let nominal = stated.as_ref().unwrap_or(null);
    let predictor = problem.predictor(&nominal.hypothesis, &nominal.x);
    // A kink is seen in short windows only, of samples that are close.
    let series = &some_fine(recording, recording.horizon, MOST_SAMPLES);
    let all = innovations(
        &predictor,
        series,
        recording.horizon,
        recording.restart_half_width,
    );
    if all.is_empty() {
        return Vec::new();
    }
    let predictions: Vec<Vec<f64>> = series.iter().map(|s| predictor.predict(s)).collect();
    let told_of = |evidence: Evidence| {
        let told = Told::of(recording, series, &evidence)?;
        Some((evidence, told))
    };
    let ranked = evidence::Axes::new(&all, series).ranked();
    let mut axes: Vec<(Evidence, Told)> =
        ranked.into_iter().filter_map(told_of).take(AXES).collect();
    let third = (axes.len() == AXES).then(|| axes.pop()).flatten();
    let half_width_s = recording.restart_half_width;
    let told: Vec<&str> = axes.iter().map(|(evidence, _)| evidence.axis).collect();
    let grown = grown(series, &predictions, half_width_s, &told);
    let speaks = |grown: &Evidence| {
        let third = third.as_ref();
        third.is_none_or(|(third, _)| GROWN_WEIGHT * grown.strength >= third.strength)
    };
    axes.extend(grown.filter(speaks).and_then(told_of));
    let is_new = |(third, _): &(Evidence, Told)| axes.iter().all(|(e, _)| e.axis != third.axis);
    let third = third.filter(is_new);
    axes.extend(third);
    // The axis that best predicts the missing torque comes first.
    if let Some(first) = missing(recording).and_then(told_of) {
        let known = axes.iter().position(|(e, _)| e.axis == first.0.axis);
        let first = known.map_or(first, |place| axes.remove(place));
        axes.insert(0, first);
        axes.truncate(AXES);
    }
    let (first, second): (Vec<_>, Vec<_>) = axes
        .into_iter()
        .map(|(_, told)| (told.first, told.second))
        .unzip();
    first
        .into_iter()
        .chain(second.into_iter().flatten())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::AFTER_REST;
    use crate::fit::hypothesis::{Hypothesis, priors};
    use crate::fit::part::Part;
    use crate::made;

    fn found(effects: &[&str]) -> Vec<Region> {
        let recording = made::recording(effects);
        let problem = made::problem(&recording);
        let null = problem.fit(&Hypothesis { terms: Vec::new() }, Vec::new(), Part::All, 1);
        regions(&problem, &null, None)
    }

    fn on<'a>(axis: &str, found: &'a [Region]) -> &'a Region {
        let told = found.iter().take(AXES);
        told.into_iter()
            .find(|r| r.axis == axis)
            .unwrap_or_else(|| panic!("no {axis} in {found:?}"))
    }

    #[test]
    fn nothing_is_located_where_nothing_is_missing() {
        assert_eq!(found(&[]), Vec::new());
    }

    #[test]
    fn numbers_that_have_gone_to_make_up_for_the_gap_do_not_hide_it() {
        let mut recording = made::recording(&["spring:stiffness=0.032,zero=0"]);
        recording.tolerance.set("stiffness", 0.02);
        let problem = Problem {
            priors: priors(&recording),
            ..made::problem(&recording)
        };
        let null = problem.fit(&Hypothesis { terms: Vec::new() }, vec![0.0], Part::All, 9);
        assert!(null.is_strained() && problem.gap_over_floor(&null) < 2.0);
        on("position", &regions(&problem, &null, None));
    }

    #[test]
    fn a_stop_is_a_stretch_of_position() {
        let found = found(&["end_stop:lower=-9,upper=0.2,stiffness=5,damping=0.01"]);
        let stop = on("position", &found);
        assert!(
            stop.from.unwrap() > 0.1 && stop.to.unwrap() > 0.2,
            "{stop:?}"
        );
        assert!(
            stop.share_of_gap > 0.8 && stop.share_of_samples < 0.5,
            "{stop:?}"
        );
    }

    /// What is told over time of a hand that is there from `from` to `to`, in s.
    fn hand(from: f64, to: f64) -> Region {
        let hand = "contact:position=-9,side=1,stiffness=0.001,damping=0.01";
        let found = found(&[&format!("{hand},from={from},to={to}")]);
        on("time", &found).clone()
    }

    #[test]
    fn a_hand_is_a_stretch_of_time_in_one_run() {
        let hand = hand(8.0, 8.4);
        assert_eq!(hand.run, Some(1));
        assert!(
            hand.from.unwrap() > 7.7 && hand.to.unwrap() < 8.8,
            "{hand:?}"
        );
        assert!(hand.share_of_gap > 0.8, "{hand:?}");
    }

    #[test]
    fn a_hand_that_comes_again_is_told_over_time() {
        let times = [[1.0, 1.6], [4.5, 5.2], [7.0, 7.5], [9.5, 10.4]];
        let hands = times.iter().zip(1..).map(|([from, to], i)| {
            format!("position_{i}=-9,side_{i}=1,from_{i}={from},to_{i}={to}")
        });
        let hands = hands.collect::<Vec<_>>().join(",");
        let found = found(&[&format!("contact:stiffness=1e-4,damping=0.001,{hands}")]);
        let told = on("time", &found);
        let [begins, ends] = [told.from.unwrap(), told.to.unwrap()];
        assert!(
            times.iter().any(|[from, to]| begins < *to && ends > *from),
            "{told:?}"
        );
    }

    #[test]
    fn what_hardly_reaches_back_into_the_run_before_is_told_of_one_run() {
        let hand = hand(5.95, 9.0);
        assert_eq!(hand.run, Some(1));
        assert!(hand.share_of_gap > 0.8, "{hand:?}");
    }

    #[test]
    fn what_comes_late_is_a_band_of_frequencies() {
        on("frequency", &found(&["delay:time=4e-3"]));
        on("frequency", &found(&["sensor_lag:time=4e-3"]));
    }

    #[test]
    fn what_comes_at_reversals_is_told_as_wide_as_the_motion_that_shows_it() {
        let found = found(&["presliding:distance=0.03"]);
        let rest = on("velocity", &found);
        assert_eq!(rest.name.as_deref(), Some(AFTER_REST));
        assert!(
            rest.from.unwrap() < -0.5 && rest.to.unwrap() > 0.5,
            "{rest:?}"
        );
    }

    #[test]
    fn friction_goes_with_velocity_and_gain_with_input() {
        assert_eq!(found(&["viscous:coefficient=0.003"])[0].axis, "velocity");
        assert_eq!(found(&["asymmetric_coulomb"])[0].axis, "velocity");
        on("input", &found(&["torque_gain:gain=1.3"]));
    }
}
