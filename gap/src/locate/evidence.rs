//! Scores of the axes: how strongly each axis is related to the gap.

use super::bins::{Bins, Point, Stretch};
use super::decomposition::Decomposition;
use super::innovation::{Coordinate, Innovation};
use super::recurrence::Recurrence;
use super::spectrum;
use crate::diagnosis::MeasuredBy;
use crate::windows::series::Series;

/// Number of bins of an axis.
pub(super) const BINS: usize = 40;
/// Number of bins of time for the search of short events.
const TIME_BINS: usize = 80;
/// Number of bins of time for a slow change.
const COARSE_TIME_BINS: usize = 8;
/// Least surplus of a stretch. Below it the gap is taken as spread over the whole axis.
pub(super) const LEAST_SURPLUS: f64 = 0.1;
/// Weight of the surplus of a run. Some runs always have a surplus because the excitation is uneven.
const RUN_WEIGHT: f64 = 0.5;
/// Weight of the surplus of a frequency band. The errors at standstill and at reversals are never white, so some band always has a
/// surplus.
const BAND_WEIGHT: f64 = 0.75;
/// Weight of the acceleration. It follows from the input and the position, so it correlates with the gap whenever they do.
const ACCELERATION_WEIGHT: f64 = 0.7;
/// Number of bins of time that hold a few separate events.
const EVENTS: usize = 4;
/// Surplus of the squared residuals beyond which a stretch of time, or the few densest bins of time, are an event. No other axis can
/// locate an event.
const EVENT_SURPLUS: f64 = 0.65;
/// Least surplus of an event by the robust measure. A permanent fault can grow into a large error at one instant; its surplus by the
/// robust measure stays small.
const ROBUST_EVENT_SURPLUS: f64 = 0.3;
/// Surplus of the squared residuals beyond which the robust measure is not considered.
const NEARLY_ALL: f64 = 0.9;
/// Score that the time axis gains if the gap is an event.
const EVENT_STRENGTH: f64 = 0.5;
/// Share of the surplus of a stretch of time that must lie in one run for the stretch to be limited to that run.
const MOST_OF_STRETCH: f64 = 0.9;
/// Weight of a slow change of the friction over time. The large weight is safe because a periodic error does not contribute to it.
const SLOW_CHANGE_WEIGHT: f64 = 2.5;
/// Weight of the gap at instants whose motion causes no gap at other times.
const NON_RECURRING_WEIGHT: f64 = 1.25;
/// Weight of the share of the missing acceleration that recurs only with the motion shortly before.
const MEMORY_WEIGHT: f64 = 3.0;

/// The score of one axis with its bins and its best stretch.
pub(super) struct Evidence {
    pub axis: &'static str,
    /// Name of the coordinate on the axis.
    pub along: &'static str,
    pub measured_by: MeasuredBy,
    pub bins: Bins,
    pub stretch: Stretch,
    /// Mean half range that the coordinate covers during one short prediction of the stretch, weighted by the excess.
    pub reach: f64,
    /// True if the stretch holds the predictions at a standstill or a reversal and shortly after.
    pub after_rest: bool,
    pub strength: f64,
}

impl Evidence {
    /// The score of an axis whose stretch is reported unchanged.
    pub(super) fn new(axis: &'static str, bins: Bins, stretch: Stretch, strength: f64) -> Self {
        Self {
            axis,
            along: axis,
            measured_by: MeasuredBy::ShortPredictions,
            bins,
            stretch,
            reach: 0.0,
            after_rest: false,
            strength,
        }
    }
}

/// The axes of the motion: name, mean coordinate of an innovation, and half the range of the coordinate during the innovation.
const OF_MOTION: [(&str, Coordinate, Coordinate); 4] = [
    ("velocity", |i| i.velocity, |i| i.velocity_reach),
    ("position", |i| i.position, |i| i.position_reach),
    ("input", |i| i.input, |i| i.input_reach),
    ("acceleration", |i| i.acceleration, |_| 0.0),
];

/// Computes the score of every axis from the innovations.
///
/// The score is half by the squared residuals and half by the robust measure, so that one large error does not decide it. If the gap is
/// an event, the score is by the squared residuals alone. The reported stretches and their shares always go by the squared residuals,
/// which define the gap.
pub(super) struct Axes<'a> {
    all: &'a [Innovation],
    decomposition: Decomposition,
    recurrence: Recurrence,
    series: &'a [Series],
    /// True if most of the gap lies in one stretch of time or in a few short ones.
    is_event: bool,
}

impl<'a> Axes<'a> {
    pub(super) fn new(all: &'a [Innovation], series: &'a [Series]) -> Self {
        let axes = Self {
            all,
            decomposition: Decomposition::of(all),
            recurrence: Recurrence::of(all, TIME_BINS),
            series,
            is_event: false,
        };
        let is_event = axes.is_event().unwrap_or(false);
        Self { is_event, ..axes }
    }

    /// True if most of the gap lies in one stretch of time or in the few densest bins of time.
    fn is_event(&self) -> Option<bool> {
        let bins = self.bins(|i| i.session_s, |i| i.excess, TIME_BINS)?;
        let robust = self.bins(|i| i.session_s, Innovation::robust, TIME_BINS)?;
        let one = bins.best(None)?;
        let robust_one = robust.stretch(one.from, one.to);
        let stands_out = |squares: f64, robust: f64| {
            squares > NEARLY_ALL || squares > EVENT_SURPLUS && robust > ROBUST_EVENT_SURPLUS
        };
        let few_bins_stand_out = stands_out(
            bins.surplus_of_densest(EVENTS),
            robust.surplus_of_densest(EVENTS),
        );
        Some(few_bins_stand_out || stands_out(one.surplus(), robust_one.surplus()))
    }

    /// The scores of all axes that can be scored, highest first.
    pub(super) fn ranked(&self) -> Vec<Evidence> {
        let of_motion = OF_MOTION.map(|(axis, place, reach)| match axis {
            "velocity" => self.velocity(place, reach),
            "input" => self.input(place, reach),
            _ => self.axis_of_motion(axis, place, reach),
        });
        let others = [self.time(), self.run(), self.frequency()];
        let mut axes: Vec<Evidence> = of_motion.into_iter().chain(others).flatten().collect();
        axes.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        axes
    }

    fn bins(
        &self,
        at: impl Fn(&Innovation) -> f64,
        excess: Coordinate,
        count: usize,
    ) -> Option<Bins> {
        let points = self.all.iter().enumerate().map(|(index, i)| Point {
            at: at(i),
            index,
            block: i.window,
            weight: i.samples,
            excess: excess(i),
        });
        Bins::new(points.collect(), count)
    }

    /// Share of the squared missing acceleration that is a function of the coordinate, after the constant and the Coulomb friction are
    /// subtracted.
    fn explained(&self, bins: &Bins) -> f64 {
        self.decomposition.remainder_share * bins.explained(|i| self.decomposition.remainder[i])
    }

    /// Share of the squared missing acceleration that is a function of the coordinate with the sign of the velocity: a friction that
    /// changes along the axis.
    fn explained_along(&self, bins: &Bins) -> f64 {
        let along = |i: usize| self.decomposition.remainder[i] * self.all[i].direction();
        self.decomposition.remainder_share * bins.explained(along)
    }

    /// The stretch with the largest surplus: by the squared residuals if the gap is an event, else by the robust measure.
    fn best(&self, at: Coordinate) -> Option<Stretch> {
        let measure: Coordinate = if self.is_event {
            |i| i.excess
        } else {
            Innovation::robust
        };
        let bins = self.bins(at, measure, BINS)?;
        Some(bins.best(None).unwrap_or_else(|| bins.whole()))
    }

    /// Mean of `reach` over the innovations in a stretch, weighted by their excess.
    fn reach(&self, stretch: &Stretch, at: Coordinate, reach: impl Fn(&Innovation) -> f64) -> f64 {
        let inside = self.all.iter();
        let inside = inside.filter(|&i| at(i) >= stretch.from && at(i) <= stretch.to);
        let (sum, weight) = inside.fold((0.0, 0.0), |(sum, weight), i| {
            (sum + i.excess * reach(i), weight + i.excess)
        });
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    fn axis_of_motion(
        &self,
        axis: &'static str,
        at: Coordinate,
        reach: Coordinate,
    ) -> Option<Evidence> {
        let bins = self.bins(at, |i| i.excess, BINS)?;
        let stands_out = |stretch: &Stretch| stretch.surplus() >= LEAST_SURPLUS;
        let best = self.best(at)?;
        let stretch = Some(best)
            .filter(stands_out)
            .map(|best| bins.stretch(best.from, best.to))
            .filter(stands_out)
            .or_else(|| bins.best(None).filter(stands_out))
            .unwrap_or_else(|| bins.whole());
        let uniform = match axis {
            "velocity" => self.decomposition.direction,
            "position" | "input" => self.decomposition.constant,
            _ => 0.0,
        };
        let explained = self.explained(&bins).max(self.explained_along(&bins));
        let weight = if axis == "acceleration" {
            ACCELERATION_WEIGHT
        } else {
            1.0
        };
        let surplus = 0.5 * (best.surplus() + stretch.surplus());
        let strength = weight * (surplus + explained + uniform);
        Some(Evidence {
            reach: self.reach(&stretch, at, reach),
            ..Evidence::new(axis, bins, stretch, strength)
        })
    }

    /// The velocity axis. A gap at reversals, or shortly after them, belongs to it as well, for both directions.
    fn velocity(&self, at: Coordinate, reach: Coordinate) -> Option<Evidence> {
        let now = self.axis_of_motion("velocity", at, reach)?;
        let near_rest = self.bins(|i| i.slowest.abs(), |i| i.excess, BINS)?;
        let rest = near_rest.best_from_start();
        let surplus = self.best(at)?.surplus();
        if rest.surplus() <= surplus || self.grows_with_speed(&near_rest, &rest) {
            return Some(now);
        }
        let bins = self.bins(|i| i.slowest, |i| i.excess, BINS)?;
        let stretch = bins.stretch(-rest.to, rest.to);
        let since = |i: &Innovation| i.velocity.abs() - i.slowest.abs();
        Some(Evidence {
            strength: now.strength + rest.surplus() - surplus,
            reach: self.reach(&stretch, |i| i.slowest, since),
            after_rest: true,
            along: "slowest velocity from shortly before on",
            stretch,
            bins,
            ..now
        })
    }

    /// True if most of the missing acceleration is a function of the speed, and mainly outside `rest`. A small error of the friction
    /// shifts the instant of standstill, so the error near standstill is large although its cause is not there.
    fn grows_with_speed(&self, speeds: &Bins, rest: &Stretch) -> bool {
        let along = |i: usize| self.all[i].missing * self.all[i].direction();
        let [at_rest, in_motion] = speeds.explained_up_to(rest.to, along);
        at_rest < in_motion && at_rest + in_motion > 0.5
    }

    /// The input axis. An event at large inputs of both signs belongs to it as well.
    fn input(&self, at: Coordinate, reach: Coordinate) -> Option<Evidence> {
        let now = self.axis_of_motion("input", at, reach)?;
        if !self.is_event {
            return Some(now);
        }
        let size = self.bins(|i| i.input_peak.abs(), |i| i.excess, BINS)?;
        let large = size.best_to_end();
        let surplus = self.best(at)?.surplus();
        if large.surplus() <= surplus.max(EVENT_SURPLUS) {
            return Some(now);
        }
        let bins = self.bins(|i| i.input_peak, |i| i.excess, BINS)?;
        let whole = bins.whole();
        let below = bins.stretch(whole.from, -large.from);
        let above = bins.stretch(large.from, whole.to);
        Some(Evidence {
            strength: now.strength + large.surplus() - surplus,
            stretch: if below.share_of_gap > above.share_of_gap {
                below
            } else {
                above
            },
            bins,
            along: "largest input during a short prediction",
            reach: 0.0,
            ..now
        })
    }

    /// The time axis, on the clock of the session. The best stretch is limited to one run if that run has nearly all of the surplus, or
    /// if the times of the runs overlap.
    fn time(&self) -> Option<Evidence> {
        let bins = self.bins(|i| i.session_s, |i| i.excess, TIME_BINS)?;
        let coarse = self.bins(|i| i.session_s, |i| i.excess, COARSE_TIME_BINS)?;
        let mut stretch = bins.best(None)?;
        let surplus = if self.is_event {
            stretch.surplus() + EVENT_STRENGTH
        } else {
            NON_RECURRING_WEIGHT * self.recurrence.non_recurring
        };
        let strength = surplus + SLOW_CHANGE_WEIGHT * self.explained_along(&coarse);
        let spans = self.series.iter().filter_map(Series::session_span_s);
        let cut = spans.map(|[from, to]| bins.stretch(from.max(stretch.from), to.min(stretch.to)));
        let cut = cut.max_by(|a, b| a.share_of_gap.total_cmp(&b.share_of_gap))?;
        let overlap = self.series.iter().any(|s| s.session_offset_s != 0.0);
        if overlap || cut.surplus() >= MOST_OF_STRETCH * stretch.surplus() {
            stretch = cut;
        }
        Some(Evidence::new(
            "time",
            bins.with_own_blocks(),
            stretch,
            strength,
        ))
    }

    /// The run with the largest surplus.
    fn run(&self) -> Option<Evidence> {
        let bins = self.bins(|i| i.run as f64, |i| i.excess, BINS)?;
        let runs = self
            .series
            .iter()
            .map(|s| bins.stretch(s.run as f64 - 0.5, s.run as f64 + 0.5));
        let stretch = runs.max_by(|a, b| a.surplus().total_cmp(&b.surplus()))?;
        let strength = RUN_WEIGHT * stretch.surplus();
        (stretch.surplus() > LEAST_SURPLUS)
            .then(|| Evidence::new("run", bins.with_own_blocks(), stretch, strength))
    }

    /// The frequency axis. An error that is a function of the change of the input is an error of phase and adds to its score.
    fn frequency(&self) -> Option<Evidence> {
        let points = spectrum::points(self.all, &self.decomposition.remainder);
        let bins = Bins::new(points, BINS)?;
        let stretch = bins.best(None)?;
        let change = self.bins(|i| i.input_change, |i| i.excess, BINS)?;
        let phase_error = self.explained(&change) + MEMORY_WEIGHT * self.recurrence.memory;
        let strength = BAND_WEIGHT * stretch.surplus() + phase_error;
        Some(Evidence {
            measured_by: MeasuredBy::Spectrum,
            ..Evidence::new("frequency", bins, stretch, strength)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_at_inputs_of_both_signs_is_located_beyond_a_size_of_the_input() {
        let innovation = |i: usize| {
            let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let is_large = i % 25 < 2;
            Innovation {
                window: i,
                session_s: i as f64,
                input_peak: sign * if is_large { 9.0 } else { 1.0 },
                input: sign,
                samples: 1.0,
                excess: if is_large { 50.0 } else { 0.1 },
                ..Innovation::default()
            }
        };
        let all: Vec<Innovation> = (0..400).map(innovation).collect();
        let axes = Axes {
            is_event: true,
            ..Axes::new(&all, &[])
        };
        let input = axes.input(|i| i.input, |_| 0.0).unwrap();
        assert!(input.stretch.from.abs() > 1.0 && input.stretch.to.abs() > 1.0);
        assert!(input.strength > EVENT_SURPLUS, "{}", input.strength);
    }
}
