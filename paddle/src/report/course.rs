//! What a run did and what both models made of it.

use gap::{Outcome, measure};
use host_sim::device::Device;
use recording::Recording;

/// One run.
#[derive(Clone, Debug)]
pub struct Course {
    /// Index of the run in the recording.
    pub run: usize,
    /// Its file.
    pub file: String,
    /// s.
    pub time: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// As the nominal model predicts it.
    pub nominal: Vec<f64>,
    /// As the corrected model predicts it; `None` if nothing was corrected.
    pub corrected: Option<Vec<f64>>,
}

/// All runs of `recording`, predicted over its horizon.
pub fn courses(recording: &Recording, outcome: &Outcome) -> Vec<Course> {
    let (_, nominal) = measure(recording, &Device::nominal(&recording.model));
    let corrected = (!outcome.diagnosis.effects.is_empty())
        .then(|| measure(recording, &outcome.model.device()).1);
    let runs = nominal.into_iter().enumerate();
    runs.map(|(run, predicted)| Course {
        run,
        corrected: corrected.as_ref().map(|all| all[run].predicted.clone()),
        file: predicted.file,
        time: predicted.time,
        measured: predicted.measured,
        nominal: predicted.predicted,
    })
    .collect()
}

impl Course {
    /// Measured minus nominal.
    pub fn nominal_residual(&self) -> Vec<f64> {
        difference(&self.measured, &self.nominal)
    }

    /// Measured minus corrected.
    pub fn corrected_residual(&self) -> Option<Vec<f64>> {
        Some(difference(&self.measured, self.corrected.as_ref()?))
    }

    /// Sum of the squares of measured minus nominal.
    pub fn badness(&self) -> f64 {
        self.nominal_residual().iter().map(|r| r * r).sum()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The stretch of `span_s`, beginning at a restart, in which the nominal model is worst: index of the course and the
/// rows.
pub fn worst(
    courses: &[Course],
    horizon_s: f64,
    span_s: f64,
) -> Option<(usize, std::ops::Range<usize>)> {
    let stretches = courses.iter().enumerate().flat_map(|(index, course)| {
        let start = course.time.first().copied().unwrap_or(0.0);
        let end = course.time.last().copied().unwrap_or(0.0);
        let residual = course.nominal_residual();
        // The last one may begin early enough to be whole.
        let restarts = ((end - start - span_s) / horizon_s).ceil().max(0.0) as usize;
        (0..=restarts).map(move |k| {
            let from = start + k as f64 * horizon_s;
            let row = |at: f64| course.time.partition_point(|t| *t < at);
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

    fn course(time: Vec<f64>, residual: Vec<f64>) -> Course {
        Course {
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
    fn the_worst_stretch_begins_at_a_restart() {
        let time = clock(3000);
        let residual = time
            .iter()
            .map(|t| if (1.3..1.4).contains(t) { 1.0 } else { 0.0 })
            .collect();
        let courses = [course(clock(3000), vec![0.1; 3000]), course(time, residual)];
        assert_eq!(worst(&courses, 0.5, 1.0).unwrap().0, 1);
        let (_, rows) = worst(&courses, 0.5, 1.0).unwrap();
        assert!(
            rows.contains(&1300) && rows.contains(&1399) && rows.start % 500 == 0,
            "{rows:?}"
        );
        assert_eq!(
            worst(&[course(clock(10), vec![1.0; 10])], 0.5, 1.0),
            Some((0, 0..10))
        );
    }
}
