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
    /// What the actuator was told.
    pub input: Vec<f64>,
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
    let runs = recording.runs.iter().zip(nominal).enumerate();
    runs.map(|(run, (recorded, predicted))| Course {
        run,
        input: recorded.input.clone(),
        corrected: corrected.as_ref().map(|all| all[run].predicted.clone()),
        file: predicted.file,
        time: predicted.time,
        measured: predicted.measured,
        nominal: predicted.predicted,
    })
    .collect()
}

/// Shortest prediction that shows where the gap arises, s.
const SHORTEST_S: f64 = 0.02;
/// Each length that is tried is this much longer than the one before.
const GROWTH: f64 = 2.0;
/// Over its floor, a gap that noise does not hide.
const CLEAR: f64 = 1.5;

/// All runs predicted over so short a time that the gap is seen where it arises, and that time in s: the shortest over
/// which noise does not hide it.
pub fn arising(recording: &Recording, outcome: &Outcome) -> (f64, Vec<Course>) {
    let nominal = Device::nominal(&recording.model);
    let mut short = recording.clone();
    short.horizon = SHORTEST_S.min(recording.horizon);
    while short.horizon < recording.horizon {
        let (gap, _) = measure(&short, &nominal);
        if gap.before > CLEAR * gap.floor {
            break;
        }
        short.horizon = (GROWTH * short.horizon).min(recording.horizon);
    }
    (short.horizon, courses(&short, outcome))
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

    /// Rate of `values`, over ± `half_width_s`.
    pub fn rate(&self, values: &[f64], half_width_s: f64) -> Vec<f64> {
        let (mut from, mut to) = (0, 0);
        let rates = self.time.iter().enumerate().map(|(i, now)| {
            while from < i && self.time[from] < now - half_width_s {
                from += 1;
            }
            while to + 1 < self.time.len() && (to <= i || self.time[to] < now + half_width_s) {
                to += 1;
            }
            match self.time[to] - self.time[from] {
                span if span > 0.0 => (values[to] - values[from]) / span,
                _ => 0.0,
            }
        });
        rates.collect()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Root mean square of `values` over equal stretches of `places`, between the ends that hold all but the rarest
/// places; not a number where a stretch is nearly empty.
pub fn profile(places: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    const STRETCHES: usize = 60;
    const FEWEST: usize = 5;
    const RAREST: f64 = 0.001;
    let mut sorted = places.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get(((sorted.len().max(1) - 1) as f64 * share) as usize);
    let (Some(&low), Some(&high)) = (at(RAREST), at(1.0 - RAREST)) else {
        return Vec::new();
    };
    if low >= high {
        return Vec::new();
    }
    let width = (high - low) / STRETCHES as f64;
    let mut sums = [(0.0, 0); STRETCHES];
    for (place, value) in places.iter().zip(values) {
        if (low..=high).contains(place) {
            let (sum, count) = &mut sums[(((place - low) / width) as usize).min(STRETCHES - 1)];
            *sum += value * value;
            *count += 1;
        }
    }
    let middles = (0..STRETCHES).map(|i| low + (i as f64 + 0.5) * width);
    let rms = |&(sum, count): &(f64, usize)| match count >= FEWEST {
        true => (sum / count as f64).sqrt(),
        false => f64::NAN,
    };
    middles.zip(sums.iter().map(rms)).collect()
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
            input: vec![0.0; time.len()],
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
    fn the_rate_of_a_line_is_its_slope_up_to_the_ends() {
        let time = clock(100);
        let line: Vec<f64> = time.iter().map(|t| 3.0 - 2.0 * t).collect();
        let course = course(time, line.clone());
        assert!(
            course
                .rate(&line, 8e-3)
                .iter()
                .all(|rate| (rate + 2.0).abs() < 1e-9)
        );
        assert_eq!(self::course(vec![0.0], vec![1.0]).rate(&[1.0], 8e-3), [0.0]);
    }

    #[test]
    fn a_profile_shows_the_guilty_place_and_leaves_holes_open() {
        let mut places: Vec<f64> = (0..6000).map(|k| f64::from(k) / 6000.0).collect();
        places.retain(|p| !(0.7..0.8).contains(p));
        let values: Vec<f64> = places
            .iter()
            .map(|p| if *p > 0.9 { 3.0 } else { 1.0 })
            .collect();
        let profile = profile(&places, &values);
        let at = |place: f64| {
            profile
                .iter()
                .min_by(|a, b| (a.0 - place).abs().total_cmp(&(b.0 - place).abs()))
                .unwrap()
                .1
        };
        assert_eq!((at(0.3), at(0.95)), (1.0, 3.0));
        assert!(at(0.75).is_nan());
        assert!(self::profile(&[1.0, 1.0], &[1.0, 1.0]).is_empty());
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
