//! What speaks for each axis.

use super::bins::{Bins, Point, Stretch};
use super::innovation::{Innovation, Place};
use super::level::Level;
use super::recurrence::Recurrence;
use super::spectrum;
use crate::diagnosis::MeasuredBy;
use crate::windows::series::Series;

/// Bins of an axis.
pub(super) const BINS: usize = 40;
/// Bins of time, where short events are looked for.
const TIME_BINS: usize = 80;
/// Bins in which a slow course over time is looked for.
const COARSE_TIME_BINS: usize = 8;
/// A surplus below this is no place: the gap then goes with the axis all along.
pub(super) const LEAST_SURPLUS: f64 = 0.1;
/// Weight of a run: some always stand out, as excitation is uneven.
const RUN_WEIGHT: f64 = 0.5;
/// Weight of a band of frequencies: what is missing at rests and reversals is never white.
const BAND_WEIGHT: f64 = 0.75;
/// Weight of the acceleration: it follows from the input and the place, and stands out wherever they do.
const SHADOW_WEIGHT: f64 = 0.7;
/// Bins of time that the moments of a recording take, wherever they lie.
const EVENTS: usize = 4;
/// With at least this surplus they, or one stretch, are an event, which no other axis can place.
const EVENT_SURPLUS: f64 = 0.65;
/// And this much by the robust measure: what grows out of a fault that is there all along is no event.
const ROBUST_EVENT_SURPLUS: f64 = 0.3;
/// Unless this surplus by the squares says that it is nearly all of the gap.
const NEARLY_ALL: f64 = 0.9;
/// What that is worth.
const EVENT_STRENGTH: f64 = 0.5;
/// Share of the surplus of a stretch of time that lies in one run for no other to be told of.
const MOST_OF_STRETCH: f64 = 0.9;
/// Weight of a slow course of friction over time: what repeats itself has none.
const COURSE_WEIGHT: f64 = 2.5;
/// Weight of moments whose motion brings no gap at other times. Of 2495 places on blind sets 96 % are among the first three with
/// this and the next, 94.5 % with neither; a fifth more or less of either moves two in a thousand.
const ONCE_WEIGHT: f64 = 1.25;
/// Weight of what comes again with what led to a motion only.
const MEMORY_WEIGHT: f64 = 3.0;

/// What speaks for an axis.
pub(super) struct Evidence {
    pub axis: &'static str,
    /// What a place on it is.
    pub along: &'static str,
    pub measured_by: MeasuredBy,
    pub bins: Bins,
    pub stretch: Stretch,
    /// How far what lies in the stretch reaches beyond it.
    pub reach: f64,
    /// True if the stretch is what comes at a rest and right after.
    pub after_rest: bool,
    pub strength: f64,
}

impl Evidence {
    /// Of what is told just as it lies on the axis.
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

/// Axes of which the motion alone decides where it is on them: the middle of an innovation there, and how far it reaches
/// to either side.
const OF_MOTION: [(&str, Place, Place); 4] = [
    ("velocity", |i| i.velocity, |i| i.velocity_reach),
    ("position", |i| i.position, |i| i.position_reach),
    ("input", |i| i.input, |i| i.input_reach),
    ("acceleration", |i| i.acceleration, |_| 0.0),
];

/// The axes of some innovations, and what speaks for each.
///
/// How strongly an axis speaks goes half by the robust measure, so that one violent moment does not decide it, unless the
/// gap is such moments; the stretches that are told, and their shares, go by the squares, of which the gap is made.
pub(super) struct Axes<'a> {
    all: &'a [Innovation],
    level: Level,
    recurrence: Recurrence,
    series: &'a [Series],
    /// True if the gap is an event.
    event: bool,
}

impl<'a> Axes<'a> {
    pub(super) fn new(all: &'a [Innovation], series: &'a [Series]) -> Self {
        let axes = Self {
            all,
            level: Level::of(all),
            recurrence: Recurrence::of(all, TIME_BINS),
            series,
            event: false,
        };
        let event = axes.is_event().unwrap_or(false);
        Self { event, ..axes }
    }

    /// True if most of the gap lies in one stretch of time or in a few moments.
    fn is_event(&self) -> Option<bool> {
        let bins = self.bins(|i| i.session_s, |i| i.excess, TIME_BINS)?;
        let robust = self.bins(|i| i.session_s, Innovation::robust, TIME_BINS)?;
        let one = bins.best(None)?;
        let beside = robust.stretch(one.from, one.to);
        let stands_out = |squares: f64, robust: f64| {
            squares > NEARLY_ALL || squares > EVENT_SURPLUS && robust > ROBUST_EVENT_SURPLUS
        };
        let few = stands_out(bins.densest(EVENTS), robust.densest(EVENTS));
        Some(few || stands_out(one.surplus(), beside.surplus()))
    }

    /// Every axis that says something, the most telling first.
    pub(super) fn ranked(&self) -> Vec<Evidence> {
        let of_motion = OF_MOTION.map(|(axis, place, reach)| match axis {
            "velocity" => self.velocity(place, reach),
            "input" => self.input(place, reach),
            _ => self.plain(axis, place, reach),
        });
        let others = [self.time(), self.run(), self.frequency()];
        let mut axes: Vec<Evidence> = of_motion.into_iter().chain(others).flatten().collect();
        axes.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        axes
    }

    fn bins(&self, at: impl Fn(&Innovation) -> f64, excess: Place, count: usize) -> Option<Bins> {
        let points = self.all.iter().enumerate().map(|(index, i)| Point {
            at: at(i),
            index,
            block: i.window,
            weight: i.samples,
            excess: excess(i),
        });
        Bins::new(points.collect(), count)
    }

    /// Share of what is missing that is a function of the place, constant and level of friction apart.
    fn explained(&self, bins: &Bins) -> f64 {
        self.level.share_of_rest * bins.explained(|i| self.level.rest[i])
    }

    /// The same along the motion: friction that changes with the place.
    fn explained_along(&self, bins: &Bins) -> f64 {
        let along = |i: usize| self.level.rest[i] * self.all[i].direction();
        self.level.share_of_rest * bins.explained(along)
    }

    /// The best stretch by the measure that decides.
    fn best(&self, at: Place) -> Option<Stretch> {
        let measure: Place = if self.event {
            |i| i.excess
        } else {
            Innovation::robust
        };
        let bins = self.bins(at, measure, BINS)?;
        Some(bins.best(None).unwrap_or_else(|| bins.whole()))
    }

    /// How far what lies in a stretch reaches beyond it, in the mean over the excess.
    fn reach(&self, stretch: &Stretch, at: Place, reach: impl Fn(&Innovation) -> f64) -> f64 {
        let inside = self.all.iter();
        let inside = inside.filter(|&i| at(i) >= stretch.from && at(i) <= stretch.to);
        let (sum, weight) = inside.fold((0.0, 0.0), |(sum, weight), i| {
            (sum + i.excess * reach(i), weight + i.excess)
        });
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    fn plain(&self, axis: &'static str, at: Place, reach: Place) -> Option<Evidence> {
        let bins = self.bins(at, |i| i.excess, BINS)?;
        let standing_out = |stretch: &Stretch| stretch.surplus() >= LEAST_SURPLUS;
        let best = self.best(at)?;
        let stretch = Some(best)
            .filter(standing_out)
            .map(|best| bins.stretch(best.from, best.to))
            .filter(standing_out)
            .or_else(|| bins.best(None).filter(standing_out))
            .unwrap_or_else(|| bins.whole());
        let everywhere = match axis {
            "velocity" => self.level.direction,
            "position" | "input" => self.level.constant,
            _ => 0.0,
        };
        let course = self.explained(&bins).max(self.explained_along(&bins));
        let weight = if axis == "acceleration" {
            SHADOW_WEIGHT
        } else {
            1.0
        };
        let surplus = 0.5 * (best.surplus() + stretch.surplus());
        let strength = weight * (surplus + course + everywhere);
        Some(Evidence {
            reach: self.reach(&stretch, at, reach),
            ..Evidence::new(axis, bins, stretch, strength)
        })
    }

    /// Velocity; what comes at a reversal or shortly after, in either direction, belongs to it, too.
    fn velocity(&self, at: Place, reach: Place) -> Option<Evidence> {
        let now = self.plain("velocity", at, reach)?;
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

    /// True if most of what is missing is a function of the speed, and most of that away from `rest`: a little more or less of
    /// a friction decides when it comes to rest, so that what is missed there is large.
    fn grows_with_speed(&self, speeds: &Bins, rest: &Stretch) -> bool {
        let along = |i: usize| self.all[i].missing * self.all[i].direction();
        let [at_rest, in_motion] = speeds.explained_up_to(rest.to, along);
        at_rest < in_motion && at_rest + in_motion > 0.5
    }

    /// Input; an event that comes with large ones of either sign belongs to it, too.
    fn input(&self, at: Place, reach: Place) -> Option<Evidence> {
        let now = self.plain("input", at, reach)?;
        if !self.event {
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

    /// Time, on the clock of the session, the best stretch cut to one run if that has nearly all of it, or if the runs' own times
    /// overlap.
    fn time(&self) -> Option<Evidence> {
        let bins = self.bins(|i| i.session_s, |i| i.excess, TIME_BINS)?;
        let coarse = self.bins(|i| i.session_s, |i| i.excess, COARSE_TIME_BINS)?;
        let mut stretch = bins.best(None)?;
        let surplus = if self.event {
            stretch.surplus() + EVENT_STRENGTH
        } else {
            ONCE_WEIGHT * self.recurrence.once
        };
        let strength = surplus + COURSE_WEIGHT * self.explained_along(&coarse);
        let spans = self.series.iter().filter_map(Series::session_span_s);
        let cut = spans.map(|[from, to]| bins.stretch(from.max(stretch.from), to.min(stretch.to)));
        let cut = cut.max_by(|a, b| a.share_of_gap.total_cmp(&b.share_of_gap))?;
        let overlap = self.series.iter().any(|s| s.session_offset_s != 0.0);
        if overlap || cut.surplus() >= MOST_OF_STRETCH * stretch.surplus() {
            stretch = cut;
        }
        Some(Evidence::new("time", bins.each_alone(), stretch, strength))
    }

    /// The run that carries most beyond its share.
    fn run(&self) -> Option<Evidence> {
        let bins = self.bins(|i| i.run as f64, |i| i.excess, BINS)?;
        let runs = self
            .series
            .iter()
            .map(|s| bins.stretch(s.run as f64 - 0.5, s.run as f64 + 0.5));
        let stretch = runs.max_by(|a, b| a.surplus().total_cmp(&b.surplus()))?;
        let strength = RUN_WEIGHT * stretch.surplus();
        (stretch.surplus() > LEAST_SURPLUS)
            .then(|| Evidence::new("run", bins.each_alone(), stretch, strength))
    }

    /// A band of frequencies; what goes with the change of the input is an error of phase and belongs here.
    fn frequency(&self) -> Option<Evidence> {
        let points = spectrum::points(self.all, &self.level.rest);
        let bins = Bins::new(points, BINS)?;
        let stretch = bins.best(None)?;
        let change = self.bins(|i| i.input_change, |i| i.excess, BINS)?;
        let of_phase = self.explained(&change) + MEMORY_WEIGHT * self.recurrence.memory;
        let strength = BAND_WEIGHT * stretch.surplus() + of_phase;
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
    fn kicks_of_either_sign_are_beyond_a_size_of_input() {
        let innovation = |i: usize| {
            let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let kicks = i % 25 < 2;
            Innovation {
                window: i,
                session_s: i as f64,
                input_peak: sign * if kicks { 9.0 } else { 1.0 },
                input: sign,
                samples: 1.0,
                excess: if kicks { 50.0 } else { 0.1 },
                ..Innovation::default()
            }
        };
        let all: Vec<Innovation> = (0..400).map(innovation).collect();
        let axes = Axes {
            event: true,
            ..Axes::new(&all, &[])
        };
        let input = axes.input(|i| i.input, |_| 0.0).unwrap();
        assert!(input.stretch.from.abs() > 1.0 && input.stretch.to.abs() > 1.0);
        assert!(input.strength > EVENT_SURPLUS, "{}", input.strength);
    }
}
