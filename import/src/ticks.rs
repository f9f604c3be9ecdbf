//! Interpolates between the rows of a log at the ticks of the device's control loop.

/// The rows of a log on the ticks of the control loop.
pub(crate) struct Ticks {
    /// Tick of each row, counted from the first row.
    pub of_row: Vec<usize>,
}

impl Ticks {
    /// The ticks of rows at these times. There is at least one tick between two rows.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of ticks"
    )]
    pub fn of(time: &[f64], tick_s: f64) -> Self {
        let first = time.first().copied().unwrap_or(0.0);
        let mut before = 0;
        let of_row = time.iter().enumerate().map(|(row, t)| {
            let tick = ((t - first) / tick_s).round() as usize;
            before = if row == 0 { 0 } else { tick.max(before + 1) };
            before
        });
        Self {
            of_row: of_row.collect(),
        }
    }

    /// Number of ticks from the first to the last row, both included.
    pub fn count(&self) -> usize {
        self.of_row.last().map_or(0, |last| last + 1)
    }

    /// A column at each tick, interpolated by monotone cubics (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5,
    /// 1984), which do not overshoot.
    pub fn between(&self, column: &[f64]) -> Vec<f64> {
        let at: Vec<f64> = self.of_row.iter().map(|tick| *tick as f64).collect();
        let slopes = monotone_slopes(&at, column);
        let mut ticks = Vec::with_capacity(self.count());
        for row in 0..column.len().saturating_sub(1) {
            let h = at[row + 1] - at[row];
            for tick in self.of_row[row]..self.of_row[row + 1] {
                let u = (tick as f64 - at[row]) / h;
                let v = 1.0 - u;
                ticks.push(
                    (1.0 + 2.0 * u) * v * v * column[row]
                        + u * v * v * h * slopes[row]
                        + u * u * (3.0 - 2.0 * u) * column[row + 1]
                        - u * u * v * h * slopes[row + 1],
                );
            }
        }
        ticks.extend(column.last());
        ticks
    }

    /// Means of a column of ticks from each row until the next. The last row has its own tick only.
    pub fn means(&self, ticks: &[f64]) -> Vec<f64> {
        let ends = self.of_row.iter().skip(1).copied().chain([self.count()]);
        let rows = self.of_row.iter().zip(ends);
        rows.map(|(&from, to)| ticks[from..to].iter().sum::<f64>() / (to - from) as f64)
            .collect()
    }

    /// Undoes the first-order low-pass `y += a (x - y)` that the loop applied to a column at each tick.
    pub fn without_low_pass(&self, column: &[f64], gain: f64) -> Vec<f64> {
        let filtered = self.between(column);
        let undone = |tick: &usize| match tick.checked_sub(1) {
            Some(before) => (filtered[*tick] - (1.0 - gain) * filtered[before]) / gain,
            None => filtered[*tick],
        };
        self.of_row.iter().map(undone).collect()
    }
}

fn monotone_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let count = x.len().min(y.len());
    let h: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let d: Vec<f64> = y
        .windows(2)
        .zip(&h)
        .map(|(pair, h)| (pair[1] - pair[0]) / h)
        .collect();
    let mut slopes = vec![0.0; count];
    for at in 1..count.saturating_sub(1) {
        let (before, after) = (d[at - 1], d[at]);
        if before * after > 0.0 {
            let (w1, w2) = (2.0 * h[at] + h[at - 1], h[at] + 2.0 * h[at - 1]);
            slopes[at] = (w1 + w2) / (w1 / before + w2 / after);
        }
    }
    match d.len() {
        0 => {}
        1 => slopes.fill(d[0]),
        n => {
            slopes[0] = end_slope(h[0], h[1], d[0], d[1]);
            slopes[n] = end_slope(h[n - 1], h[n - 2], d[n - 1], d[n - 2]);
        }
    }
    slopes
}

/// One-sided slope at the end of three points that preserves monotonicity.
fn end_slope(h0: f64, h1: f64, d0: f64, d1: f64) -> f64 {
    let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if slope * d0 <= 0.0 {
        0.0
    } else if d0 * d1 < 0.0 && slope.abs() > 3.0 * d0.abs() {
        3.0 * d0
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_applied_low_pass_is_undone() {
        let gain = 0.22;
        let raw: Vec<f64> = (0..400).map(|k| (0.02 * f64::from(k)).sin()).collect();
        let mut y = raw[0];
        let filtered: Vec<f64> = raw
            .iter()
            .map(|x| {
                y += gain * (x - y);
                y
            })
            .collect();
        let rows: Vec<usize> = (0..400).step_by(3).collect();
        let time: Vec<f64> = rows.iter().map(|k| *k as f64 * 1e-3).collect();
        let logged: Vec<f64> = rows.iter().map(|k| filtered[*k]).collect();
        let ticks = Ticks::of(&time, 1e-3);
        let undone = ticks.without_low_pass(&logged, gain);
        let worst = rows
            .iter()
            .zip(&undone)
            .skip(2)
            .map(|(k, x)| (raw[*k] - x).abs())
            .fold(0.0, f64::max);
        assert!(worst < 3e-3, "{worst}");
    }

    #[test]
    fn rows_at_irregular_times_have_different_ticks() {
        let ticks = Ticks::of(&[5.0, 5.0007, 5.00175, 5.0018], 0.00035);
        assert_eq!(ticks.of_row, [0, 2, 5, 6]);
        assert_eq!(
            ticks.means(&[1.0, 3.0, 5.0, 5.0, 5.0, 7.0, 9.0]),
            [2.0, 5.0, 7.0, 9.0]
        );
    }
}
