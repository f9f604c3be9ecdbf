//! Finds oddities that do not prevent the use of a recording.

use super::spikes::{SPIKE, usual};
use crate::statistics::{is_constant, median, noise, quantile};
use crate::{Oddity, Run, Sensor};

/// Jitter: least spread of the middle 90 % of the periods, as a share of their median.
const JITTER: f64 = 0.1;
/// Quantisation: least average number of repetitions of a value.
const REPEATS: usize = 4;
/// Least factor between the observed and the stated quantum.
const QUANTUM: f64 = 1.5;
/// The observed quantum is this quantile of the distances between neighbouring values.
const QUANTUM_QUANTILE: f64 = 0.1;
/// Largest distance from a grid point, as a share of the quantum, for a value on the grid. The grid is real if
/// [`ON_GRID_SHARE`] of the distances are on it.
const ON_GRID: f64 = 0.1;
/// Least share of distances on the grid, see [`ON_GRID`].
const ON_GRID_SHARE: f64 = 0.9;
/// Smaller distances between neighbouring values, as a share of their span, are rounding errors of the printed digits.
const PRINTED: f64 = 1e-6;
/// Least factor of the observed noise over the stated one that is reported.
const NOISIER: f64 = 5.0;
/// Least quantum of a supply reading that is reported, as a share of the reading.
const SUPPLY: f64 = 0.005;

/// Oddities of one run. `stated` is the sensor of its position. `frozen` lists the ignored columns that never change.
pub(crate) fn run(run: &Run, stated: &Sensor, frozen: &[String]) -> Vec<Oddity> {
    let mut found = Vec::new();
    let jitter = jitter(run);
    // With jitter, successive samples differ by more than noise.
    if jitter.is_none() {
        found.extend(noisy(run, stated));
    }
    found.extend(jitter);
    found.extend(gaps(run));
    if is_constant(&run.input) {
        found.push(Oddity::ConstantInput {
            file: run.file.clone(),
            value: run.input[0],
        });
    }
    found.extend(frozen_columns(run, frozen));
    found.extend(resolution(run, stated.resolution));
    found.extend(coarse_supply(run));
    found
}

/// Reports runs that overlap in time, unless the time of all runs starts at about the same value.
pub(crate) fn session(runs: &[Run]) -> Vec<Oddity> {
    let mut spans: Vec<(f64, f64, &str)> = runs
        .iter()
        .filter_map(|run| Some((*run.time.first()?, *run.time.last()?, run.file.as_str())))
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (spans.first(), spans.last()) else {
        return Vec::new();
    };
    let shortest = spans
        .iter()
        .map(|(start, end, _)| end - start)
        .fold(f64::INFINITY, f64::min);
    // Runs whose first rows were removed start at slightly different times.
    if last.0 - first.0 < shortest / 2.0 {
        return Vec::new();
    }
    let overlapping = spans.windows(2).filter(|pair| pair[1].0 <= pair[0].1);
    overlapping
        .map(|pair| Oddity::Overlap {
            first: pair[0].2.to_owned(),
            second: pair[1].2.to_owned(),
        })
        .collect()
}

fn jitter(run: &Run) -> Option<Oddity> {
    let periods = run.periods();
    let [p05_s, median_s, p95_s] = [0.05, 0.5, 0.95].map(|part| quantile(periods.clone(), part));
    (p95_s - p05_s > JITTER * median_s).then(|| Oddity::Jitter {
        file: run.file.clone(),
        p05_s,
        median_s,
        p95_s,
    })
}

fn gaps(run: &Run) -> Option<Oddity> {
    let periods = run.periods();
    let gaps = run.gaps();
    let longest = gaps
        .iter()
        .max_by(|a, b| periods[**a].total_cmp(&periods[**b]));
    let &at = longest?;
    Some(Oddity::Gaps {
        file: run.file.clone(),
        count: gaps.len(),
        longest_s: periods[at],
        at_s: run.time[at],
        median_s: median(periods),
    })
}

fn frozen_columns(run: &Run, ignored: &[String]) -> Vec<Oddity> {
    let narrow = [
        ("current", &run.current),
        ("supply", &run.supply),
        ("temperature", &run.temperature),
    ];
    let narrow = narrow
        .into_iter()
        .filter(|(_, column)| column.as_deref().is_some_and(is_constant));
    let further = run
        .positions
        .iter()
        .filter(|(_, column)| is_constant(column));
    let names = narrow
        .map(|(name, _)| name)
        .chain(further.map(|(name, _)| name.as_str()));
    let names = names.chain(ignored.iter().map(String::as_str));
    names
        .map(|column| Oddity::FrozenColumn {
            file: run.file.clone(),
            column: column.to_owned(),
        })
        .collect()
}

/// Reports a first sample that is far from the extrapolation of the next two samples: by [`SPIKE`] times the following
/// steps. No motion starts like that.
pub(crate) fn stale_start(run: &Run) -> Option<Oddity> {
    let next = run.position.get(1..5)?;
    let off = (run.position[0] - (2.0 * next[0] - next[1])).abs();
    let mut steps = next.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let is_apart = steps.all(|step| off > SPIKE * step) && off > SPIKE * usual(&run.position);
    is_apart.then(|| Oddity::StaleStart {
        file: run.file.clone(),
        off,
    })
}

fn resolution(run: &Run, stated: f64) -> Option<Oddity> {
    let Quantum {
        step: seen,
        quantised,
    } = quantum(&run.position)?;
    let coarser = quantised && seen > QUANTUM * stated;
    let finer = stated > 0.0 && seen * QUANTUM < stated;
    (coarser || finer).then(|| Oddity::Resolution {
        file: run.file.clone(),
        seen,
        stated,
    })
}

fn noisy(run: &Run, sensor: &Sensor) -> Option<Oddity> {
    let stated = sensor.deviation();
    let seen = noise(&run.position);
    (stated > 0.0 && seen > NOISIER * stated).then(|| Oddity::Noisy {
        file: run.file.clone(),
        seen,
        stated,
    })
}

struct Quantum {
    /// A typical small distance between neighbouring distinct values.
    step: f64,
    /// True if the values repeat and lie on a grid with that step.
    quantised: bool,
}

#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
fn quantum(column: &[f64]) -> Option<Quantum> {
    let mut values = column.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let span = values.last()? - values.first()?;
    values.dedup_by(|b, a| *b - *a <= PRINTED * span);
    let distances: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step = quantile(distances.clone(), QUANTUM_QUANTILE);
    let on_grid = |distance: &&f64| (*distance / step - (*distance / step).round()).abs() < ON_GRID;
    let on_grid = distances.iter().filter(on_grid).count() as f64;
    let quantised =
        values.len() * REPEATS <= column.len() && on_grid >= ON_GRID_SHARE * distances.len() as f64;
    (!distances.is_empty()).then_some(Quantum { step, quantised })
}

fn coarse_supply(run: &Run) -> Option<Oddity> {
    let supply: Vec<f64> = run
        .supply
        .as_ref()?
        .iter()
        .map(|volts| f64::from(*volts))
        .collect();
    let Quantum { step, quantised } = quantum(&supply)?;
    let share = step / median(supply).abs();
    (quantised && share >= SUPPLY).then(|| Oddity::CoarseSupply {
        file: run.file.clone(),
        step,
        percent: 100.0 * share,
    })
}
