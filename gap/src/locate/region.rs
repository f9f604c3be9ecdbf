//! Builds the regions that are reported for one axis.

use super::bins::Stretch;
use super::evidence::{Evidence, LEAST_SURPLUS};
use crate::diagnosis::{AFTER_REST, Profile, ProfilePart, Region};
use crate::windows::series::Series;
use recording::Recording;

/// The reported regions of one axis.
pub(super) struct AxisRegions {
    /// The region of the best stretch.
    pub first: Region,
    /// The region of the next best stretch that stands out.
    pub second: Option<Region>,
}

impl AxisRegions {
    /// Builds the regions of the axis of `evidence`. Returns `None` if no stretch carries clearly more of the gap than its share of the
    /// samples.
    pub(super) fn of(
        recording: &Recording,
        series: &[Series],
        evidence: &Evidence,
    ) -> Option<Self> {
        let builder = RegionBuilder {
            recording,
            series,
            evidence,
        };
        let best = || evidence.bins.best(None);
        let (stretch, mut first) = builder
            .clear_region(evidence.stretch, None)
            .or_else(|| builder.clear_region(best()?, None))?;
        // A second stretch makes no sense on the axis of runs, which has no order.
        let other = (evidence.axis != "run").then(|| evidence.bins.best(Some(&stretch)));
        let other = other.flatten().filter(|s| s.surplus() > LEAST_SURPLUS);
        let mut second = other.and_then(|other| builder.clear_region(other, Some(&stretch)));
        let stretches = [Some(stretch), second.as_ref().map(|(stretch, _)| *stretch)];
        let stretches: Vec<Stretch> = stretches.into_iter().flatten().collect();
        let parts = evidence.bins.split_at(&stretches);
        first.profile = Some(builder.profile(&parts, &stretch));
        if let Some((stretch, region)) = &mut second {
            region.profile = Some(builder.profile(&parts, stretch));
        }
        Some(Self {
            first,
            second: second.map(|(_, region)| region),
        })
    }
}

/// Turns stretches of one axis into regions.
struct RegionBuilder<'a> {
    recording: &'a Recording,
    series: &'a [Series],
    evidence: &'a Evidence,
}

impl RegionBuilder<'_> {
    /// The stretch that is reported, with its region. The stretch is widened by `reach` if it then overlaps no other stretch and still
    /// carries clearly more of the gap than of the samples. Otherwise it stays as it is. Returns `None` if even that is not clear.
    fn clear_region(&self, stretch: Stretch, other: Option<&Stretch>) -> Option<(Stretch, Region)> {
        let Evidence { bins, reach, .. } = self.evidence;
        // After a standstill the coordinate is the slowest velocity, to which the reach of the velocity does not apply.
        let reach = if self.evidence.after_rest {
            0.0
        } else {
            *reach
        };
        let wide = bins.stretch(stretch.from - reach, stretch.to + reach);
        let is_free = other.is_none_or(|other| !other.overlaps(&wide));
        let all = [is_free.then_some(wide), Some(stretch)].into_iter();
        let mut widths = all.flatten().map(|s| (s, self.region(s)));
        widths.find(|(_, region)| region.is_clear())
    }

    fn region(&self, stretch: Stretch) -> Region {
        let evidence = self.evidence;
        let is_at_standstill = evidence.after_rest && stretch == evidence.stretch;
        let beyond = if evidence.after_rest {
            evidence.reach
        } else {
            0.0
        };
        let mut region = Region {
            axis: evidence.axis,
            from: Some(stretch.from - beyond),
            to: Some(stretch.to + beyond),
            name: is_at_standstill.then(|| AFTER_REST.to_owned()),
            run: None,
            measured_by: evidence.measured_by,
            share_of_gap: stretch.share_of_gap,
            share_of_gap_interval: evidence.bins.interval(&stretch),
            share_of_samples: stretch.share_of_weight,
            profile: None,
        };
        match evidence.axis {
            "run" => {
                let index = (0.5 * (stretch.from + stretch.to)) as usize;
                region.name = Some(self.recording.runs[index].file.clone());
                region.run = Some(index);
                (region.from, region.to) = (None, None);
            }
            "time" => {
                if let Some((series, _)) = self.run_with(&stretch) {
                    region.run = Some(series.run);
                    region.from = Some(stretch.from - series.session_offset_s);
                    region.to = Some(stretch.to - series.session_offset_s);
                }
            }
            _ => {}
        }
        region
    }

    /// The run that contains a stretch of the session time, with the begin and end of the run on the clock of the session, s.
    fn run_with(&self, stretch: &Stretch) -> Option<(&Series, [f64; 2])> {
        self.series.iter().find_map(|series| {
            let span = series.session_span_s()?;
            let is_inside = stretch.from >= span[0] && stretch.to <= span[1];
            is_inside.then_some((series, span))
        })
    }

    /// The profile of the axis over its `parts`, with a marked stretch.
    fn profile(&self, parts: &[Stretch], stretch: &Stretch) -> Profile {
        let whole = self.evidence.bins.whole();
        // Run `i` covers the coordinates from `i - 0.5` to `i + 0.5`.
        let run = |part: &Stretch| self.recording.runs.get((part.from + 0.5) as usize);
        let is_of_runs = self.evidence.axis == "run";
        let parts = parts.iter().map(|part| ProfilePart {
            run: run(part).filter(|_| is_of_runs).map(|run| run.file.clone()),
            from: part.from,
            to: part.to,
            share_of_gap: part.share_of_gap,
            share_of_samples: part.share_of_weight,
        });
        let mut profile = Profile {
            along: self.evidence.along,
            parts: parts.collect(),
            marked: [stretch.from, stretch.to].map(|end| end.clamp(whole.from, whole.to)),
        };
        let run = self.run_with(stretch);
        if let Some((series, span)) = run.filter(|_| self.evidence.axis == "time") {
            within(&mut profile, span, series.session_offset_s);
        }
        profile
    }
}

/// Keeps the parts of a profile over the session time that lie in one run, on the clock of that run.
fn within(profile: &mut Profile, [from, to]: [f64; 2], offset_s: f64) {
    profile
        .parts
        .retain(|part| part.to > from && part.from < to);
    for part in &mut profile.parts {
        part.from -= offset_s;
        part.to -= offset_s;
    }
    for end in &mut profile.marked {
        *end -= offset_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;

    /// Share of the gap over share of the samples, within and outside the marked stretch of a region, from its plotted profile.
    fn densities(region: &Region) -> [f64; 2] {
        let profile = region.profile.as_ref().unwrap();
        let [from, to] = profile.marked;
        let mut sums = [[0.0; 2]; 2];
        for part in &profile.parts {
            let is_outside = usize::from(part.from < from || part.to > to);
            sums[is_outside][0] += part.share_of_gap;
            sums[is_outside][1] += part.share_of_samples;
        }
        sums.map(|[gap, samples]| gap / samples)
    }

    #[test]
    fn a_region_agrees_with_its_plotted_profile_and_is_clear() {
        let hidden: [&[&str]; 8] = [
            &["viscous:coefficient=0.003"],
            &["torque_gain:gain=1.3"],
            &["delay:time=4e-3"],
            &["presliding:distance=0.03"],
            &["spring:stiffness=0.06,zero=0"],
            &["end_stop:lower=-9,upper=0.2,stiffness=5,damping=0.01"],
            &["contact:position=-9,side=1,stiffness=0.001,damping=0.01,from=8,to=8.4"],
            &["stribeck:static_ratio=1.8", "torque_offset:torque=0.004"],
        ];
        for effects in hidden {
            let recording = made::recording(effects);
            let problem = made::problem(&recording);
            let bare = Hypothesis { terms: Vec::new() };
            let null = problem.fit(&bare, Vec::new(), Part::All, 1);
            let regions = super::super::regions(&problem, &null, None);
            assert!(!regions.is_empty(), "{effects:?}");
            for region in &regions {
                let [inside, outside] = densities(region);
                assert!(
                    inside > outside,
                    "{effects:?}: {inside} {outside} {region:?}"
                );
                // The profile gives the printed share of the gap.
                let share = inside * region.share_of_samples;
                assert!(region.is_clear(), "{effects:?}: {region:?}");
                assert!(
                    (share - region.share_of_gap).abs() < 1e-6,
                    "{share}: {region:?}"
                );
            }
        }
    }
}
