//! Finds starts for effects whose cost has many local optima.

use super::evolution::evolved;
use super::screening_set::{MANY_ITERATIONS, ScreeningSet, lowest};
use crate::fit::Fit;
use crate::floor::WHITE;
use crate::term::Term;
use rayon::prelude::*;

/// Largest number of starts of lowest cost that a scan returns for fits.
const SCANNED_FITTED: usize = 4;
/// Initial standard deviation of an evolution from a point of a scan, in scales of the coordinates.
const WIDELY: f64 = 0.5;
/// Least share of the excess that the lowest point of a scan must close before an evolution begins there. It did so in 51 of 53 recordings
/// of blind sets with backlash, and in 21 of 85 without.
const LEAST_SCAN_GAIN: f64 = 0.02;
/// Least gain at the lowest point of a scan, as a share of the gain of the best other effect, for an evolution over a quarter of the
/// horizon. Backlash beside another effect has at least 0.14, and backlash alone has far more.
const LEAST_SCAN_LEAD: f64 = 0.1;
/// Least gain after the evolution over a quarter of the horizon, as a share of the gain of the best other effect, for an evolution over the
/// whole horizon. Backlash beside another effect has at least 0.23.
const LEAST_SEARCH_LEAD: f64 = 0.2;
/// Number of lowest points of a scan from which evolutions begin. The right point was among them in all of 16 recordings.
const SEARCHED: usize = 2;

/// Returns the highest cost at which an evolution from a start begins. The start must close enough of the excess, and a `share` of the gain
/// of `best`.
fn worth(field: &ScreeningSet<'_>, best: &Fit, share: f64) -> f64 {
    let known = field.cost_of(field.known);
    let closed = known - field.cost_of(best);
    known - (LEAST_SCAN_GAIN * (known - WHITE)).max(share * closed)
}

/// Returns the `kept` starts of lowest cost without a fit.
fn near(field: &ScreeningSet<'_>, starts: &[Term], kept: usize) -> Vec<Term> {
    let costs = starts.par_iter().map(|start| (field.cost(start), start));
    lowest(costs.collect(), kept)
}

/// Returns the starts, each after a short fit.
fn followed(field: &ScreeningSet<'_>, starts: &[Term]) -> Vec<Term> {
    let fits = starts.par_iter().map(|s| field.fit(s, MANY_ITERATIONS));
    fits.filter_map(|fit| fit.last_term()).collect()
}

/// Returns the starts of lowest cost around the lowest points of two scans: one on the windows of `field`, and one on `soon`, which has the
/// same data with restarts four times as often. Far from the right parameters the lowest point of the first scan may be a wrong one.
pub(super) fn scanned(
    field: &ScreeningSet<'_>,
    soon: Option<&ScreeningSet<'_>>,
    starts: &[Term],
) -> Vec<Term> {
    let mut low = minima(starts, |start| field.cost(start));
    // If the frequency of a model is wrong, its phase error increases over the horizon. It is smaller over a quarter of the horizon.
    if let Some(soon) = soon {
        let early = minima(starts, |start| soon.cost(start));
        low.extend(followed(soon, &early));
        low.extend(early);
    }
    let around = low.iter().flat_map(|start| near(field, &start.around(), 1));
    near(field, &around.collect::<Vec<_>>(), SCANNED_FITTED)
}

/// Returns the starts of lowest cost of an effect whose impacts cause many local optima. The evolution begins at the lowest points of a
/// scan over a quarter of the horizon, where there are fewer optima.
pub(super) fn searched(
    field: &ScreeningSet<'_>,
    soon: Option<&ScreeningSet<'_>>,
    starts: &[Term],
    best: &Fit,
) -> Vec<Term> {
    let soon = soon.unwrap_or(field);
    let mut low = minima(starts, |start| soon.cost(start));
    low.truncate(SEARCHED);
    let leads = |on: &ScreeningSet<'_>, to: &[Term], share| {
        let lowest = to.first().map(|start| on.cost(start));
        lowest.is_some_and(|cost| cost <= worth(on, best, share))
    };
    if !leads(soon, &low, LEAST_SCAN_LEAD) {
        return low;
    }
    let early = near(field, &descended(soon, &low), SCANNED_FITTED);
    if !leads(field, &early, LEAST_SEARCH_LEAD) {
        return early;
    }
    near(field, &descended(field, &early), SCANNED_FITTED)
}

/// Returns the starts, each after an evolution.
fn descended(field: &ScreeningSet<'_>, starts: &[Term]) -> Vec<Term> {
    let found = starts.par_iter().map(|start| {
        let x = vec![0.0; start.free.len()];
        let (_, x) = evolved(x, WIDELY, |x| field.cost(&start.moved(x)));
        start.moved(&x)
    });
    found.collect()
}

/// Returns the lowest local minima of a scan. `starts` are in the order of the scan, first for one side of the sensor and then for the
/// other. Of starts with the same first parameter, the one of lowest cost counts.
fn minima(starts: &[Term], cost: impl Fn(&Term) -> f64 + Sync) -> Vec<Term> {
    let costs: Vec<f64> = starts.par_iter().map(&cost).collect();
    let costs: Vec<(f64, &Term)> = costs.into_iter().zip(starts).collect();
    let sizes = costs.chunk_by(|(_, a), (_, b)| a.values[0] == b.values[0]);
    let sizes: Vec<(f64, &Term)> = sizes
        .filter_map(|same| same.iter().min_by(|a, b| a.0.total_cmp(&b.0)).copied())
        .collect();
    let beside = |i: usize, j: Option<usize>| {
        j.and_then(|j| sizes.get(j))
            .filter(|(_, start)| start.sensor_on_load == sizes[i].1.sensor_on_load)
            .map_or(f64::INFINITY, |(cost, _)| *cost)
    };
    let minima = (0..sizes.len())
        .filter(|&i| sizes[i].0 <= beside(i, i.checked_sub(1)).min(beside(i, Some(i + 1))));
    lowest(minima.map(|i| sizes[i]).collect(), SCANNED_FITTED)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::select::search;

    #[test]
    fn starts_of_a_scan_lie_in_all_local_minima() {
        let recording = made::recording(&["compliance:stiffness=0.5,damping=0.002"]);
        let (scanned, low) = search::on(&recording, |search, null| {
            let chosen = vec![true; search.problem.window_count()];
            let field = ScreeningSet::new(search.problem, null, chosen);
            let candidates = search.tried(null, &[]).into_iter();
            let mut twists = candidates.filter(|c| c.effect.name() == "compliance");
            let starts = twists.next().unwrap().starts;
            let low = minima(&starts, |start| field.cost(start));
            (scanned(&field, None, &starts), low)
        });
        assert_eq!(scanned.len(), low.len());
        let places = |terms: &[Term]| {
            let places = terms.iter().map(|t| (t.sensor_on_load, t.values[0]));
            let mut places: Vec<(bool, f64)> = places.collect();
            places.sort_by(|a, b| a.1.total_cmp(&b.1));
            places
        };
        assert_eq!(places(&scanned), places(&low));
    }
}
