//! Measured position of a run with the predictions of both models.

use gap::{Outcome, measure};
use host_sim::device::Device;
use recording::Recording;

/// A run with its predictions.
#[derive(Clone, Debug)]
pub struct PredictedRun {
    /// Index of the run in the recording.
    pub run: usize,
    /// File of the run.
    pub file: String,
    /// Time, s.
    pub time: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Position predicted by the nominal model.
    pub nominal: Vec<f64>,
    /// Position predicted by the corrected model. `None` if no effect was named.
    pub corrected: Option<Vec<f64>>,
}

/// Predicts all runs of `recording` over its horizon.
pub fn predicted_runs(recording: &Recording, outcome: &Outcome) -> Vec<PredictedRun> {
    let (_, nominal) = measure(recording, &Device::nominal(&recording.model));
    let corrected = (!outcome.diagnosis.effects.is_empty())
        .then(|| measure(recording, &outcome.model.device()).1);
    let runs = nominal.into_iter().enumerate();
    runs.map(|(run, predicted)| PredictedRun {
        run,
        corrected: corrected.as_ref().map(|all| all[run].predicted.clone()),
        file: predicted.file,
        time: predicted.time,
        measured: predicted.measured,
        nominal: predicted.predicted,
    })
    .collect()
}

impl PredictedRun {
    /// Measured minus nominal position.
    pub fn nominal_residual(&self) -> Vec<f64> {
        difference(&self.measured, &self.nominal)
    }

    /// Measured minus corrected position.
    pub fn corrected_residual(&self) -> Option<Vec<f64>> {
        Some(difference(&self.measured, self.corrected.as_ref()?))
    }

    /// Sum of the squares of the nominal residual.
    pub fn nominal_squared_error(&self) -> f64 {
        self.nominal_residual().iter().map(|r| r * r).sum()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Finds the interval of length `span_s`, starting at a restart, with the largest error of the nominal model. Returns the
/// index of the run and the rows.
pub fn worst(
    predicted_runs: &[PredictedRun],
    horizon_s: f64,
    span_s: f64,
) -> Option<(usize, std::ops::Range<usize>)> {
    let stretches = predicted_runs
        .iter()
        .enumerate()
        .flat_map(|(index, predicted)| {
            let start = predicted.time.first().copied().unwrap_or(0.0);
            let end = predicted.time.last().copied().unwrap_or(0.0);
            let residual = predicted.nominal_residual();
            // The last interval starts early enough to be complete.
            let restarts = ((end - start - span_s) / horizon_s).ceil().max(0.0) as usize;
            (0..=restarts).map(move |k| {
                let from = start + k as f64 * horizon_s;
                let row = |at: f64| predicted.time.partition_point(|t| *t < at);
                let rows = row(from)..row(from + span_s);
                let sum: f64 = residual[rows.clone()].iter().map(|r| r * r).sum();
                (sum, index, rows)
            })
        });
    let worst = stretches.max_by(|a, b| a.0.total_cmp(&b.0));
    worst.map(|(_, index, rows)| (index, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predicted(time: Vec<f64>, residual: Vec<f64>) -> PredictedRun {
        PredictedRun {
            run: 0,
            file: "a.csv".into(),
            nominal: vec![0.0; time.len()],
            measured: residual,
            corrected: None,
            time,
        }
    }

    fn clock(samples: i32) -> Vec<f64> {
        (0..samples).map(|k| f64::from(k) * 1e-3).collect()
    }

    #[test]
    fn the_worst_interval_begins_at_a_restart() {
        let time = clock(3000);
        let residual = time
            .iter()
            .map(|t| if (1.3..1.4).contains(t) { 1.0 } else { 0.0 })
            .collect();
        let predicted_runs = [
            predicted(clock(3000), vec![0.1; 3000]),
            predicted(time, residual),
        ];
        assert_eq!(worst(&predicted_runs, 0.5, 1.0).unwrap().0, 1);
        let (_, rows) = worst(&predicted_runs, 0.5, 1.0).unwrap();
        assert!(
            rows.contains(&1300) && rows.contains(&1399) && rows.start % 500 == 0,
            "{rows:?}"
        );
        assert_eq!(
            worst(&[predicted(clock(10), vec![1.0; 10])], 0.5, 1.0),
            Some((0, 0..10))
        );
    }
}
