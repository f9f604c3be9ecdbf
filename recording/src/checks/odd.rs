//! Looks for what is merely odd.

use super::spikes::{SPIKE, usual};
use crate::statistics::{is_constant, median, noise, quantile};
use crate::{Oddity, Run, Sensor};

/// Jitter: the middle 90 % of the periods spread over more than this share of their median.
const JITTER: f64 = 0.1;
/// Quantised: each value comes this many times on average.
const REPEATS: usize = 4;
/// The quantum seen and the one stated differ by this factor.
const QUANTUM: f64 = 1.5;
/// The quantum seen: this quantile of the distances between neighbouring values.
const QUANTUM_QUANTILE: f64 = 0.1;
/// A value is on the grid if it is off by less than this share of the quantum, and the grid is real if
/// [`ON_GRID_SHARE`] of the distances are on it.
const ON_GRID: f64 = 0.1;
/// See [`ON_GRID`].
const ON_GRID_SHARE: f64 = 0.9;
/// Distances between neighbouring values below this share of their span are rounding of the printed digits.
const PRINTED: f64 = 1e-6;
/// Noise seen over that stated: beyond this factor something else stirs the reading.
const NOISIER: f64 = 5.0;
/// A supply that is read in steps of this share of it.
const SUPPLY: f64 = 0.005;

/// What is odd about one run; `stated` is the sensor of its position, `frozen` are the ignored columns that never change.
pub(crate) fn run(run: &Run, stated: &Sensor, frozen: &[String]) -> Vec<Oddity> {
    let mut found = Vec::new();
    let jitter = jitter(run);
    // Samples at odd times differ by more than noise.
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

/// Runs that overlap although they do not all start anew.
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
    // Trimmed runs that start anew begin a little apart.
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

/// Whether the first sample is [`SPIKE`] times farther from the line through the next two than these and the ones after are
/// from one another: a motion has no such start.
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
    /// A typical small distance of neighbouring distinct values.
    step: f64,
    /// Whether the values repeat and lie on a grid of that step.
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
