//! Bins along one axis: each bin holds a share of the gap and a share of the samples. The bins yield the stretch of the axis that carries
//! more of the gap than of the samples, and the part of a signal that is a function of the axis.

use crate::shrink::Picks;

/// One measured value with its coordinate on an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Point {
    /// Coordinate on the axis, in the unit of the axis.
    pub at: f64,
    /// Index of the value in the caller's list.
    pub index: usize,
    /// Block of the resampling, for example the prediction window of the value. Values in one block are correlated; values in different
    /// blocks are taken as independent.
    pub block: usize,
    /// Weight of the value in the shares of the samples, for example its number of samples.
    pub weight: f64,
    /// Contribution of the value to the gap, in the unit of the caller's measure.
    pub excess: f64,
}

/// Consecutive bins of an axis that have about equal weights.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    /// Sorted by the coordinate.
    points: Vec<Point>,
    /// Index of the first point of each bin, followed by the number of points.
    bounds: Vec<usize>,
    weight: f64,
    excess: f64,
}

/// An interval of an axis, with its shares of the gap and of the weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub from: f64,
    pub to: f64,
    pub share_of_gap: f64,
    pub share_of_weight: f64,
}

impl Stretch {
    /// Share of the gap less the share of the weight.
    pub(super) fn surplus(&self) -> f64 {
        self.share_of_gap - self.share_of_weight
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.from < other.to && other.from < self.to
    }
}

/// Number of bootstrap resamplings for a confidence interval.
const RESAMPLINGS: usize = 200;

impl Bins {
    /// Sorts points into about `count` bins. The number is smaller if many points have equal coordinates. Returns `None` if the sum of
    /// the weights or of the contributions is not positive.
    pub(super) fn new(mut points: Vec<Point>, count: usize) -> Option<Self> {
        points.retain(|p| p.at.is_finite());
        points.sort_by(|a, b| a.at.total_cmp(&b.at));
        let weight: f64 = points.iter().map(|p| p.weight).sum();
        let excess: f64 = points.iter().map(|p| p.excess).sum();
        if !(weight > 0.0 && excess > 0.0) {
            return None;
        }
        let mut bounds = vec![0];
        let mut seen = 0.0;
        for (i, pair) in points.windows(2).enumerate() {
            seen += pair[0].weight;
            if seen * count as f64 >= weight * bounds.len() as f64 && pair[1].at > pair[0].at {
                bounds.push(i + 1);
            }
        }
        bounds.push(points.len());
        Some(Self {
            points,
            bounds,
            weight,
            excess,
        })
    }

    /// Puts every point into a block of its own. This is for an axis that is the recording itself, such as time: one window of it is not
    /// one draw from many.
    pub(super) fn with_own_blocks(mut self) -> Self {
        for (block, point) in self.points.iter_mut().enumerate() {
            point.block = block;
        }
        self
    }

    /// Lower edge of bin `i`: the midpoint between the points on both sides.
    fn edge(&self, i: usize) -> f64 {
        let bound = self.bounds[i];
        match (bound.checked_sub(1), self.points.get(bound)) {
            (Some(before), Some(after)) => 0.5 * (self.points[before].at + after.at),
            (None, Some(first)) => first.at,
            (last, None) => last.map_or(0.0, |last| self.points[last].at),
        }
    }

    /// The whole axis.
    pub(super) fn whole(&self) -> Stretch {
        Stretch {
            from: self.points[0].at,
            to: self.points[self.points.len() - 1].at,
            share_of_gap: 1.0,
            share_of_weight: 1.0,
        }
    }

    /// The interval from `from` to `to` with its shares.
    pub(super) fn stretch(&self, from: f64, to: f64) -> Stretch {
        let inside = self.points.iter().filter(|p| p.at >= from && p.at <= to);
        let (weight, excess) = inside.fold((0.0, 0.0), |(w, e), p| (w + p.weight, e + p.excess));
        Stretch {
            from,
            to,
            share_of_gap: excess / self.excess,
            share_of_weight: weight / self.weight,
        }
    }

    /// Splits the whole axis at the edges of the bins and at the ends of `stretches`.
    pub(super) fn split_at(&self, stretches: &[Stretch]) -> Vec<Stretch> {
        let whole = self.whole();
        let inside = |end: &f64| *end > whole.from && *end < whole.to;
        let ends = stretches.iter().flat_map(|s| [s.from, s.to]).filter(inside);
        let mut edges: Vec<f64> = (0..self.bounds.len()).map(|i| self.edge(i)).collect();
        edges.extend(ends);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut first = 0;
        let last = edges.len().saturating_sub(1);
        let parts = edges.windows(2).zip(1..).map(|(ends, place)| {
            // A point at the lower end of a stretch belongs to that stretch.
            let begins = stretches.iter().any(|s| s.from == ends[1]);
            let is_before =
                |p: &Point| place == last || p.at < ends[1] || (p.at == ends[1] && !begins);
            let rest = &self.points[first..];
            let inside = &rest[..rest.partition_point(is_before)];
            first += inside.len();
            let [weight, excess] = inside
                .iter()
                .fold([0.0; 2], |[w, e], p| [w + p.weight, e + p.excess]);
            Stretch {
                from: ends[0],
                to: ends[1],
                share_of_gap: excess / self.excess,
                share_of_weight: weight / self.weight,
            }
        });
        parts.collect()
    }

    /// Share of the weight and share of the gap of each bin.
    fn sums(&self) -> Vec<[f64; 2]> {
        let sums = self.parts().map(|bin| {
            let sums = bin.iter().map(|p| [p.weight, p.excess]);
            let [w, e] = sums.fold([0.0; 2], |[w, e], [x, y]| [w + x, e + y]);
            [w / self.weight, e / self.excess]
        });
        sums.collect()
    }

    /// Sum of the surpluses of the `count` bins with the largest surplus.
    pub(super) fn surplus_of_densest(&self, count: usize) -> f64 {
        let mut surplus: Vec<f64> = self.sums().iter().map(|[w, e]| e - w).collect();
        surplus.sort_by(|a, b| b.total_cmp(a));
        surplus.iter().take(count).sum()
    }

    /// Cross-validated surplus: the points are split into two halves, and each half selects the bins with a positive surplus, whose
    /// surplus the other half then gives. Consecutive pairs of points belong to the two halves in turn.
    pub(super) fn confirmed(&self) -> f64 {
        let confirmed = self.parts().map(|bin| {
            let mut halves = [0.0f64; 2];
            for p in bin {
                halves[p.index / 2 % 2] += p.excess / self.excess - p.weight / self.weight;
            }
            let [a, b] = halves;
            let confirmed_by = |one: f64, other: f64| if one > 0.0 { other } else { 0.0 };
            confirmed_by(a, b) + confirmed_by(b, a)
        });
        confirmed.sum()
    }

    /// The stretch with the largest surplus that does not overlap `excluded`.
    pub(super) fn best(&self, excluded: Option<&Stretch>) -> Option<Stretch> {
        let sums = self.sums();
        let mut best: Option<Stretch> = None;
        for i in 0..sums.len() {
            let mut share = [0.0; 2];
            for (j, sum) in sums.iter().enumerate().skip(i) {
                share = [share[0] + sum[0], share[1] + sum[1]];
                let stretch = Stretch {
                    from: self.edge(i),
                    to: self.edge(j + 1),
                    share_of_gap: share[1],
                    share_of_weight: share[0],
                };
                let most = best.map_or(0.0, |b| b.surplus());
                if stretch.surplus() > most && !excluded.is_some_and(|t| t.overlaps(&stretch)) {
                    best = Some(stretch);
                }
            }
        }
        best
    }

    /// The stretch with the largest surplus among those that begin at the lower end of the axis.
    pub(super) fn best_from_start(&self) -> Stretch {
        let bins = self.sums().into_iter().enumerate();
        best_extension(self.edge(0), bins.map(|(i, sum)| (self.edge(i + 1), sum)))
    }

    /// The stretch with the largest surplus among those that end at the upper end of the axis.
    pub(super) fn best_to_end(&self) -> Stretch {
        let sums = self.sums();
        let end = self.edge(sums.len());
        let bins = sums.into_iter().enumerate().rev();
        best_extension(end, bins.map(|(i, sum)| (self.edge(i), sum)))
    }

    /// Share of the sum of squared values that is a function of the coordinate: the correlation ratio (Pearson, 1905). It uses only
    /// products of values from different blocks, so neither noise nor a correlation within one block counts.
    pub(super) fn explained(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.explained_in(|_| true, value)
    }

    /// Shares of the sum of squared values that are a function of the coordinate, in the bins up to `limit` and in the bins beyond it.
    pub(super) fn explained_up_to(&self, limit: f64, value: impl Fn(usize) -> f64) -> [f64; 2] {
        [true, false].map(|up_to| self.explained_in(|at| (at <= limit) == up_to, &value))
    }

    fn explained_in(&self, includes: impl Fn(f64) -> bool, value: impl Fn(usize) -> f64) -> f64 {
        let bins = self.parts().filter(|bin| includes(bin[0].at));
        let between: f64 = bins.map(|bin| across(bin, &value)).sum();
        let all: f64 = self.points.iter().map(|p| value(p.index).powi(2)).sum();
        if all > 0.0 {
            (between / all).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    fn parts(&self) -> impl Iterator<Item = &[Point]> {
        self.bounds.windows(2).map(|b| &self.points[b[0]..b[1]])
    }

    /// 95 % confidence interval of the share of the gap in `stretch`, by resampling the blocks.
    pub(super) fn interval(&self, stretch: &Stretch) -> [f64; 2] {
        let blocks = self.points.iter().map(|p| p.block).max().unwrap_or(0) + 1;
        let mut sums = vec![[0.0; 2]; blocks];
        for p in &self.points {
            sums[p.block][1] += p.excess;
            if p.at >= stretch.from && p.at <= stretch.to {
                sums[p.block][0] += p.excess;
            }
        }
        sums.retain(|s| s[1] != 0.0);
        let mut random = Picks::new();
        let mut draw = || sums[random.below(sums.len())];
        let mut shares: Vec<f64> = (0..RESAMPLINGS)
            .map(|_| {
                let drawn = (0..sums.len()).map(|_| draw());
                let [inside, all] = drawn.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
                if all > 0.0 {
                    (inside / all).clamp(0.0, 1.0)
                } else {
                    0.0
                }
            })
            .collect();
        shares.sort_by(f64::total_cmp);
        let at = |share: f64| shares[((RESAMPLINGS - 1) as f64 * share).round() as usize];
        [at(0.025), at(0.975)]
    }
}

/// The stretch with the largest surplus among those that begin at `origin` and end at one of the edges of `steps`. Each step is the next
/// edge with the shares of weight and gap up to it.
fn best_extension(origin: f64, steps: impl Iterator<Item = (f64, [f64; 2])>) -> Stretch {
    let none = Stretch {
        from: origin,
        to: origin,
        share_of_gap: 0.0,
        share_of_weight: 0.0,
    };
    let extended = steps.scan(none, |stretch, (edge, [weight, gap])| {
        stretch.from = stretch.from.min(edge);
        stretch.to = stretch.to.max(edge);
        stretch.share_of_weight += weight;
        stretch.share_of_gap += gap;
        Some(*stretch)
    });
    extended
        .max_by(|a, b| a.surplus().total_cmp(&b.surplus()))
        .unwrap_or(none)
}

/// Sum over the values of each value times the mean of the values in other blocks.
fn across(bin: &[Point], value: impl Fn(usize) -> f64) -> f64 {
    let mut values: Vec<(usize, f64)> = bin.iter().map(|p| (p.block, value(p.index))).collect();
    values.sort_by_key(|(block, _)| *block);
    let sum: f64 = values.iter().map(|(_, v)| v).sum();
    let windows = values.chunk_by(|a, b| a.0 == b.0).map(|window| {
        let others = values.len() - window.len();
        let own: f64 = window.iter().map(|(_, v)| v).sum();
        if others > 0 {
            own * (sum - own) / others as f64
        } else {
            0.0
        }
    });
    windows.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 points at the coordinates 0 to 99, with a weight of 1 each. Every fourth point is in the same block.
    fn points(excess: impl Fn(f64) -> f64) -> Vec<Point> {
        let points = (0..100).map(|i| Point {
            at: f64::from(i),
            index: i as usize,
            block: i as usize % 4,
            weight: 1.0,
            excess: excess(f64::from(i)),
        });
        points.collect()
    }

    #[test]
    fn the_stretch_is_found_and_its_shares_add_up() {
        let inside = |x: f64| if (40.0..50.0).contains(&x) { 9.0 } else { 0.1 };
        let bins = Bins::new(points(inside), 50).unwrap();
        let best = bins.best(None).unwrap();
        assert!((best.from - 39.5).abs() < 1e-9 && (best.to - 49.5).abs() < 1e-9);
        assert!((best.share_of_gap - 90.0 / 99.0).abs() < 1e-9);
        assert!((best.share_of_weight - 0.1).abs() < 1e-9);
        let [low, high] = bins.interval(&best);
        assert!(
            low < best.share_of_gap && best.share_of_gap < high,
            "{low} {high}"
        );
    }

    #[test]
    fn the_next_stretch_does_not_overlap_the_first() {
        let two = |x: f64| match x as i32 {
            20..30 => 5.0,
            70..75 => 6.0,
            _ => 0.0,
        };
        let bins = Bins::new(points(two), 20).unwrap();
        let first = bins.stretch(19.5, 29.5);
        let second = bins.best(Some(&first)).unwrap();
        assert!(second.from >= 29.5 && second.to >= 74.5, "{second:?}");
    }

    #[test]
    fn a_function_of_the_coordinate_is_explained_and_a_correlation_within_one_block_is_not() {
        let bins = Bins::new(points(|_| 1.0), 10).unwrap();
        assert!(bins.explained(|i| i as f64 - 50.0) > 0.9);
        assert!(bins.explained(|i| if i / 4 % 2 == 0 { 1.0 } else { -1.0 }) < 0.2);
        assert!(bins.explained(|i| if i % 4 == 0 { 9.0 } else { 0.0 }) < 0.1);
    }

    #[test]
    fn the_explained_share_is_split_at_the_limit() {
        let bins = Bins::new(points(|_| 1.0), 10).unwrap();
        let late_value = |i: usize| if i < 70 { 0.0 } else { 2.0 };
        let [near, beyond] = bins.explained_up_to(50.0, late_value);
        assert!(near == 0.0 && beyond > 0.9, "{near} {beyond}");
    }

    #[test]
    fn a_surplus_in_only_one_half_of_the_points_is_not_confirmed() {
        let surplus = |excess: fn(usize) -> f64| {
            let mut all = points(|_| 1.0);
            for p in &mut all {
                p.excess += excess(p.index);
            }
            Bins::new(all, 20).unwrap().confirmed()
        };
        assert!(surplus(|i| if i / 5 % 4 == 0 { 9.0 } else { 0.0 }) > 0.5);
        assert!(surplus(|i| if i % 20 == 0 { 40.0 } else { 0.0 }) < 0.1);
    }

    #[test]
    fn the_shares_of_the_parts_add_up_to_those_of_the_stretch() {
        let bins = Bins::new(points(|x| 1.0 + x), 7).unwrap();
        for (from, to) in [(20.0, 31.0), (-5.0, 12.3), (40.2, 140.0)] {
            let stretch = bins.stretch(from, to);
            let parts = bins.split_at(&[stretch]);
            let sum = |within: &dyn Fn(&Stretch) -> bool| {
                let parts = parts.iter().filter(|part| within(part));
                parts.fold([0.0; 2], |[g, w], part| {
                    [g + part.share_of_gap, w + part.share_of_weight]
                })
            };
            let [gap, weight] = sum(&|part| part.from >= from && part.to <= to);
            assert!((gap - stretch.share_of_gap).abs() < 1e-9, "{parts:?}");
            assert!((weight - stretch.share_of_weight).abs() < 1e-9, "{parts:?}");
            let [gap, weight] = sum(&|_| true);
            assert!((gap - 1.0).abs() < 1e-9 && (weight - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_stretch_from_the_start_begins_there() {
        let two = |x: f64| match x as i32 {
            0..10 => 3.0,
            70..75 => 9.0,
            _ => 0.0,
        };
        let bins = Bins::new(points(two), 20).unwrap();
        let start = bins.best_from_start();
        assert!((start.from, start.to) == (0.0, 9.5), "{start:?}");
        assert!((start.share_of_gap - 30.0 / 75.0).abs() < 1e-9);
    }

    #[test]
    fn without_excess_no_bins_are_made() {
        assert!(Bins::new(points(|_| 0.0), 10).is_none());
        assert!(Bins::new(Vec::new(), 10).is_none());
    }
}
