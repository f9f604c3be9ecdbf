//! What a perfect model would cost on a recording: of the same motion, with the same sensor.

use crate::fit::Fit;
use crate::motion::quantile;
use crate::predict::Predictor;
use crate::problem::{Part, Problem};
use crate::series::{self, Series};
use host_sim::sensors::Noise;
use recording::{Recording, Run};

/// Robust cost of a window whose residual is white and of the known size: ln(1 + 1).
pub(crate) const WHITE: f64 = core::f64::consts::LN_2;
/// Rows that suffice.
const MOST_ROWS: usize = 60_000;
/// Most that restarts and inputs may add where nothing says that the model stands in for the device.
const MOST_ADDED: f64 = 0.5;
/// Share of a time that rounding may take.
const HAIR: f64 = 1e-6;
const SEED: u64 = 0x6861_7074_6963;

/// What noise, quantising, restarts that fall on a kink and inputs that are means leave of a model that is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Perfect {
    /// Mean robust cost of a window, [`WHITE`] at least.
    pub level: f64,
    /// Standard error of that.
    pub error: f64,
    /// Of the worst window, above the mean.
    pub worst: f64,
}

impl Perfect {
    /// Of `fit`, on what its own device would have given.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Self {
        let device = fit
            .hypothesis
            .device(&problem.recording.model, &problem.nudges, &fit.x);
        let predictor = Predictor::new(device, problem.recording);
        let (mut first, mut odd) = (Vec::new(), Vec::new());
        // Odd windows of the one are even ones of the other: what recurs every other window is seen, too.
        for skipped in [0, 1] {
            let own = imagined(problem.recording, &predictor, skipped);
            let imagined = Problem {
                series: series::coarse(&own, own.horizon),
                recording: &own,
                nudges: problem.nudges.clone(),
                quarter: None,
            };
            let costs = imagined.costs(&fit.hypothesis, &fit.x, Part::All);
            let windows = imagined.series.iter().flat_map(|s| 0..s.windows.len());
            for (window, cost) in windows.zip(0..).map(|(w, i)| (w, costs.log(i))) {
                match window {
                    0 if skipped == 0 => first.push(cost),
                    _ if window % 2 == 1 => odd.push(cost),
                    _ => {}
                }
            }
        }
        let (_, error) = mean_and_error(&odd);
        let all = [first, odd].concat();
        let (mean, _) = mean_and_error(&all);
        let worst = all.iter().fold(mean, |m, c| m.max(*c));
        Self {
            level: mean.max(WHITE),
            error,
            worst: worst - mean,
        }
    }

    /// The same for a model that may be too wrong to stand in for the device.
    pub(crate) fn bounded(self) -> Self {
        Self {
            level: self.level.min(WHITE + MOST_ADDED),
            ..self
        }
    }
}

/// Mean of some values and its standard error; zeros for none.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    (mean, (variance / n).sqrt())
}

/// The recording after some `skipped` windows as `predictor` would have made it, restarted from the measured state before every even
/// window: of that nothing is left on the odd ones, and on the first, but the motion.
fn imagined(recording: &Recording, predictor: &Predictor, skipped: u8) -> Recording {
    let rows: usize = recording.runs.iter().map(|run| run.time.len()).sum();
    let share = (MOST_ROWS as f64 / rows.max(1) as f64).min(1.0);
    let mut own = Recording::new("", recording.horizon, recording.model);
    own.restart_half_width = recording.restart_half_width;
    own.sensors.clone_from(&recording.sensors);
    let skipped_s = f64::from(skipped) * recording.horizon;
    let kept = recording.runs.iter().map(|r| middle(r, share, skipped_s));
    own.runs = kept.collect();
    let sensor = recording.sensor("position");
    let mut noise = Noise::new(SEED);
    for mut series in series::full(&own, 2.0 * recording.horizon) {
        let seen = typical_noise(&series);
        if let Some(pid) = &recording.runs[series.run].controller {
            series.resample_inputs(pid, seen);
        }
        begin_at_rest(&mut series, predictor);
        // What is seen as noise has the quantising in it, which is filtered with it if it is.
        let quantum = if series.correlation > 0.0 {
            0.0
        } else {
            sensor.resolution
        };
        let added = (seen.powi(2) - quantum.powi(2) / 12.0).max(0.0).sqrt();
        let new = (1.0 - series.correlation.powi(2)).sqrt();
        let mut drift = noise.next(added);
        let position = predictor.predict(&series).into_iter().map(|x| {
            drift = series.correlation * drift + noise.next(new * added);
            let shown = x + drift;
            if quantum > 0.0 {
                (shown / quantum).round() * quantum
            } else {
                shown
            }
        });
        own.runs[series.run].position = position.collect();
    }
    own
}

/// Lets a run begin at rest where that suits its first window better: the cubic through the first samples makes a speed
/// of a break-away.
fn begin_at_rest(series: &mut Series, predictor: &Predictor) {
    let (Some(first), Some(&value)) = (series.windows.first(), series.position.first()) else {
        return;
    };
    let rows = first.samples.clone();
    let cubic = first.restart;
    let squares = |series: &Series| -> f64 {
        let predicted = predictor.predict_shifted(series, [0.0, 0.0], |w| w == 0);
        let pairs = predicted[rows.clone()]
            .iter()
            .zip(&series.position[rows.clone()]);
        pairs.map(|(p, m)| (p - m).powi(2)).sum()
    };
    let moving = squares(series);
    series.windows[0].restart = cubic.at_rest(value);
    if squares(series) >= moving {
        series.windows[0].restart = cubic;
    }
}

fn typical_noise(series: &Series) -> f64 {
    let noises: Vec<f64> = series.windows.iter().map(|w| w.noise).collect();
    quantile(&noises, 0.5)
}

/// A share of a run's rows, from its middle, without the first `skipped_s`, with the columns that a prediction needs.
fn middle(run: &Run, share: f64, skipped_s: f64) -> Run {
    let rows = run.time.len();
    let kept = ((rows as f64 * share).ceil() as usize).min(rows);
    let rows = (rows - kept) / 2..(rows - kept) / 2 + kept;
    let kept = &run.time[rows.clone()];
    let begin_s = kept
        .first()
        .map_or(0.0, |start| start + (1.0 - HAIR) * skipped_s);
    let rows = rows.start + kept.partition_point(|t| *t < begin_s)..rows.end;
    let part = |column: &[f64]| column[rows.clone()].to_vec();
    Run::new(
        run.file.clone(),
        run.drive,
        part(&run.time),
        part(&run.input),
        part(&run.position),
    )
}
