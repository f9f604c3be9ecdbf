//! Locates the gap on the axes of the data: velocity, position, input, acceleration, time, run and frequency.

mod bins;
mod decomposition;
mod evidence;
mod innovation;
mod missing;
mod recurrence;
mod region;
mod spectrum;
mod whole_horizon;

use crate::comparison::{Comparison, Outcome};
use crate::diagnosis::{MeasuredBy, Region};
use crate::fit::Fit;
use crate::fit::problem::Problem;
use crate::windows::series::{MOST_SAMPLES, some_fine};
use evidence::Evidence;
use host_sim::effects::Channel;
use innovation::innovations;
use missing::missing;
use region::AxisRegions;
use whole_horizon::whole_horizon_axis;

/// Share of the gap beyond which the sensing channel is reported first.
const MOST: f64 = 0.5;
/// Share of the samples that stands for one channel. A device has five channels, and every sample passes through each.
const ONE_CHANNEL: f64 = 0.2;
/// Number of axes that are reported.
const AXES: usize = 3;
/// Weight of the surplus of the gap at the whole horizon, relative to the score of an axis by short predictions.
const HORIZON_WEIGHT: f64 = 2.5;

/// Parts of the data that carry clearly more of the gap than their share of the samples. The best part of each axis comes first, then the
/// further parts. The sensing channel is added if a second sensor indicates it.
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

/// The sensing channel, if the model predicts the position of another sensor better.
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

/// The regions of at most three axes. Short predictions give the first two axes, which show where the gap arises. The third axis is the
/// one with the largest error at the whole horizon, unless short predictions speak much more for another axis.
///
/// Short predictions speak for an axis if one stretch carries more than its share of the gap, or if the missing acceleration is a
/// function of its coordinate beyond a constant and Coulomb friction. The motion couples the axes, so the next best axes are reported
/// too.
fn along_axes(problem: &Problem<'_>, null: &Fit) -> Vec<Region> {
    let recording = problem.recording;
    // Parameters that moved far within their tolerances hide the gap, so the stated ones are used then.
    let stated = null.is_strained().then(|| null.as_stated());
    let nominal = stated.as_ref().unwrap_or(null);
    let predictor = problem.predictor(&nominal.hypothesis, &nominal.x);
    // A sudden change is visible only in short windows with a short sample period.
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
    let with_regions = |evidence: Evidence| {
        let regions = AxisRegions::of(recording, series, &evidence)?;
        Some((evidence, regions))
    };
    let ranked = evidence::Axes::new(&all, series).ranked();
    let mut axes: Vec<(Evidence, AxisRegions)> = ranked
        .into_iter()
        .filter_map(with_regions)
        .take(AXES)
        .collect();
    let third = (axes.len() == AXES).then(|| axes.pop()).flatten();
    let half_width_s = recording.restart_half_width;
    let axes_so_far: Vec<&str> = axes.iter().map(|(evidence, _)| evidence.axis).collect();
    let at_horizon = whole_horizon_axis(series, &predictions, half_width_s, &axes_so_far);
    let is_strong = |at_horizon: &Evidence| {
        let third = third.as_ref();
        third.is_none_or(|(third, _)| HORIZON_WEIGHT * at_horizon.strength >= third.strength)
    };
    axes.extend(at_horizon.filter(is_strong).and_then(with_regions));
    let is_new =
        |(third, _): &(Evidence, AxisRegions)| axes.iter().all(|(e, _)| e.axis != third.axis);
    let third = third.filter(is_new);
    axes.extend(third);
    // The axis that best explains the missing torque comes first.
    if let Some(first) = missing(recording).and_then(with_regions) {
        let known = axes.iter().position(|(e, _)| e.axis == first.0.axis);
        let first = known.map_or(first, |place| axes.remove(place));
        axes.insert(0, first);
        axes.truncate(AXES);
    }
    let (first, second): (Vec<_>, Vec<_>) = axes
        .into_iter()
        .map(|(_, regions)| (regions.first, regions.second))
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
        let first_regions = found.iter().take(AXES);
        first_regions
            .into_iter()
            .find(|r| r.axis == axis)
            .unwrap_or_else(|| panic!("no {axis} in {found:?}"))
    }

    #[test]
    fn without_a_gap_no_region_is_reported() {
        assert_eq!(found(&[]), Vec::new());
    }

    #[test]
    fn the_gap_is_located_even_if_fitted_parameters_compensate_it() {
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
    fn an_end_stop_is_located_on_the_position_axis() {
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

    /// The region on the time axis for a contact that acts from `from` to `to`, s.
    fn hand(from: f64, to: f64) -> Region {
        let hand = "contact:position=-9,side=1,stiffness=0.001,damping=0.01";
        let found = found(&[&format!("{hand},from={from},to={to}")]);
        on("time", &found).clone()
    }

    #[test]
    fn a_contact_is_located_on_the_time_axis_within_one_run() {
        let hand = hand(8.0, 8.4);
        assert_eq!(hand.run, Some(1));
        assert!(
            hand.from.unwrap() > 7.7 && hand.to.unwrap() < 8.8,
            "{hand:?}"
        );
        assert!(hand.share_of_gap > 0.8, "{hand:?}");
    }

    #[test]
    fn a_repeated_contact_is_located_on_the_time_axis() {
        let times = [[1.0, 1.6], [4.5, 5.2], [7.0, 7.5], [9.5, 10.4]];
        let hands = times.iter().zip(1..).map(|([from, to], i)| {
            format!("position_{i}=-9,side_{i}=1,from_{i}={from},to_{i}={to}")
        });
        let hands = hands.collect::<Vec<_>>().join(",");
        let found = found(&[&format!("contact:stiffness=1e-4,damping=0.001,{hands}")]);
        let region = on("time", &found);
        let [begins, ends] = [region.from.unwrap(), region.to.unwrap()];
        assert!(
            times.iter().any(|[from, to]| begins < *to && ends > *from),
            "{region:?}"
        );
    }

    #[test]
    fn a_contact_that_hardly_overlaps_the_previous_run_is_located_in_one_run() {
        let hand = hand(5.95, 9.0);
        assert_eq!(hand.run, Some(1));
        assert!(hand.share_of_gap > 0.8, "{hand:?}");
    }

    #[test]
    fn a_delay_or_a_lag_is_located_on_the_frequency_axis() {
        on("frequency", &found(&["delay:time=4e-3"]));
        on("frequency", &found(&["sensor_lag:time=4e-3"]));
    }

    #[test]
    fn presliding_is_located_after_standstill_with_the_velocities_reached_meanwhile() {
        let found = found(&["presliding:distance=0.03"]);
        let rest = on("velocity", &found);
        assert_eq!(rest.name.as_deref(), Some(AFTER_REST));
        assert!(
            rest.from.unwrap() < -0.5 && rest.to.unwrap() > 0.5,
            "{rest:?}"
        );
    }

    #[test]
    fn friction_is_located_on_velocity_and_gain_on_input() {
        assert_eq!(found(&["viscous:coefficient=0.003"])[0].axis, "velocity");
        assert_eq!(found(&["asymmetric_coulomb"])[0].axis, "velocity");
        on("input", &found(&["torque_gain:gain=1.3"]));
    }
}
