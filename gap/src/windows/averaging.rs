//! Corrects a predicted motion for its curvature within a sample. An averaged sample is the mean of the motion over its rows. A simulated
//! low-pass takes the motion from sample to sample as a straight line, so a curved motion must be corrected by the difference of the
//! means.

/// Coefficients of the correction at each sample of a series. It is empty if the samples are not averages.
#[derive(Clone, Debug, Default)]
pub(crate) struct Averaging(Vec<SecondDifference>);

/// Weights of the second difference of the motion at a sample, and the mean of a parabola over the rows of the sample for a second
/// difference of one.
#[derive(Clone, Copy, Debug, Default)]
struct SecondDifference {
    before: f64,
    after: f64,
    mean: f64,
}

/// Mean of a parabola between two samples less that of the straight line, for a second difference of one.
const CURVED_MEAN: f64 = -1.0 / 12.0;
/// Number of samples that determine a second difference.
const FEWEST: usize = 3;

impl Averaging {
    /// Adds a window with the time of each sample, s, and the mean square distance in time of the rows of each sample from it, s².
    pub(crate) fn add_window(&mut self, time: &[f64], spreads_s2: &[f64]) {
        let differences = spreads_s2.iter().enumerate().map(|(i, spread_s2)| {
            if time.len() < FEWEST {
                return SecondDifference::default();
            }
            let middle = i.clamp(1, time.len() - 2);
            let [before_s, after_s] = [0, 1].map(|k| time[middle + k] - time[middle + k - 1]);
            let mean_s = 0.5 * (before_s + after_s);
            SecondDifference {
                before: after_s / mean_s,
                after: before_s / mean_s,
                mean: 0.5 * spread_s2 / (before_s * after_s),
            }
        });
        self.0.extend(differences);
    }

    /// Turns a motion at the samples of a window into its means over their rows. `first` is the index of the first sample of the window;
    /// `low_passes` is the number of low-passes that the motion passes.
    #[inline]
    pub(crate) fn apply(&self, first: usize, motion: &mut [f64], low_passes: usize) {
        let Some(differences) = self.0.get(first..first + motion.len()) else {
            return;
        };
        let &[a, b, c, ..] = &*motion else {
            return;
        };
        let low_pass_mean = low_passes as f64 * CURVED_MEAN;
        let mut near = [a, b, c];
        for (i, difference) in differences.iter().enumerate() {
            if i > 1 && i + 1 < motion.len() {
                near = [near[1], near[2], motion[i + 1]];
            }
            let second_difference =
                difference.before * (near[0] - near[1]) + difference.after * (near[2] - near[1]);
            motion[i] += (difference.mean + low_pass_mean) * second_difference;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averaging_gives_the_mean_of_a_parabola_over_the_rows() {
        let at = |t: f64| 1.0 + 2.0 * t - 30.0 * t * t;
        let (period, group) = (1e-3, 4);
        let rows: Vec<f64> = (0..24).map(|row| period * f64::from(row)).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let time: Vec<f64> = rows.chunks(group).map(mean).collect();
        let spread = period * period * (group * group - 1) as f64 / 12.0;
        let mut averaging = Averaging::default();
        averaging.add_window(&time, &vec![spread; time.len()]);
        let mut averaged: Vec<f64> = time.iter().map(|t| at(*t)).collect();
        averaging.apply(0, &mut averaged, 0);
        for (rows, averaged) in rows.chunks(group).zip(averaged) {
            let positions: Vec<f64> = rows.iter().map(|t| at(*t)).collect();
            assert!((averaged - mean(&positions)).abs() < 1e-12);
        }
    }
}
