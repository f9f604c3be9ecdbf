//! Resamples columns of several rates at the rows of the position.

/// A column with its own times and values.
pub(crate) struct Samples {
    time: Vec<f64>,
    values: Vec<f64>,
}

impl Samples {
    /// The non-empty cells of `column` in these rows.
    pub fn of(column: &[f64], seconds: &[f64], rows: &[usize]) -> Self {
        let filled = rows.iter().filter(|row| !column[**row].is_nan());
        let (time, values) = filled.map(|row| (seconds[*row], column[*row])).unzip();
        Self { time, values }
    }

    /// The last value at or before each of `times`. Before the first value, the first value.
    pub fn held(&self, times: &[f64]) -> Vec<f64> {
        let before = |t: &f64| self.time.partition_point(|at| at <= t).saturating_sub(1);
        times
            .iter()
            .map(|t| self.values.get(before(t)).copied().unwrap_or(f64::NAN))
            .collect()
    }

    /// The mean from each of `times` until the next, with each value held until the next one. After the last time, the last
    /// interval counts.
    pub fn means(&self, times: &[f64]) -> Vec<f64> {
        if times == self.time {
            return self.values.clone();
        }
        let held = self.held(times);
        let ends = times.iter().skip(1).copied();
        let mut means: Vec<f64> = times
            .iter()
            .zip(ends)
            .zip(&held)
            .map(|((&from, to), &first)| {
                let inside = self.time.partition_point(|at| *at <= from)
                    ..self.time.partition_point(|at| *at < to);
                if inside.is_empty() {
                    return first;
                }
                let (mut sum, mut since, mut value) = (0.0, from, first);
                for at in inside {
                    sum += value * (self.time[at] - since);
                    (since, value) = (self.time[at], self.values[at]);
                }
                (sum + value * (to - since)) / (to - from)
            })
            .collect();
        means.extend(held.last());
        means
    }

    /// Time of the first value, s.
    pub fn begin(&self) -> Option<f64> {
        self.time.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_faster_column_is_averaged_and_a_slower_one_held() {
        let seconds = [0.0, 0.25, 0.5, 1.0, 2.0];
        let rows: Vec<usize> = (0..seconds.len()).collect();
        let nan = f64::NAN;
        let fast = Samples::of(&[1.0, 2.0, 3.0, 5.0, 6.0], &seconds, &rows);
        let means = fast.means(&[0.0, 1.0, 2.0]);
        assert_eq!(means, [(0.25 + 0.5 + 1.5), 5.0, 6.0]);
        let slow = Samples::of(&[nan, 7.0, nan, nan, 8.0], &seconds, &rows);
        assert_eq!(slow.means(&[0.5, 1.0, 2.0]), [7.0, 7.0, 8.0]);
    }

    #[test]
    fn a_column_with_the_same_rows_is_unchanged() {
        let seconds = [0.0, 0.1, 0.30000000000000004];
        let column = [0.1 + 0.2, 1.0 / 3.0, 2.0];
        let samples = Samples::of(&column, &seconds, &[0, 1, 2]);
        assert_eq!(samples.means(&seconds), column);
    }
}
