//! What a sensor makes of a motion that bends within a step: samples that are put together show its mean over their rows, and a
//! low-pass that takes the way from sample to sample as even is to be told of one that is as far in the mean.

/// The bends of a motion at the samples of a series; of none where samples are not put together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Averaging(Vec<Bend>);

/// Second difference of the motion, and how far the mean over the sample's rows lies beside their middle for a difference of
/// one.
#[derive(Clone, Copy, Debug, Default)]
struct Bend {
    before: f64,
    after: f64,
    mean: f64,
}

/// How far the mean of a bent way lies beside the even one between its ends, for a second difference of one.
const BESIDE_EVEN: f64 = -1.0 / 12.0;
/// Samples that show a bend.
const BENT: usize = 3;

impl Averaging {
    /// Adds a window with samples at some times, each of rows at such a mean square distance from it, s².
    pub(crate) fn add_window(&mut self, time: &[f64], spreads_s2: &[f64]) {
        let bends = spreads_s2.iter().enumerate().map(|(i, spread_s2)| {
            if time.len() < BENT {
                return Bend::default();
            }
            let middle = i.clamp(1, time.len() - 2);
            let [before_s, after_s] = [0, 1].map(|k| time[middle + k] - time[middle + k - 1]);
            let mean_s = 0.5 * (before_s + after_s);
            Bend {
                before: after_s / mean_s,
                after: before_s / mean_s,
                mean: 0.5 * spread_s2 / (before_s * after_s),
            }
        });
        self.0.extend(bends);
    }

    /// Brings a motion at the samples of a window, of which the first is `first`, to what is shown of it behind so many
    /// low-passes.
    #[inline]
    pub(crate) fn show(&self, first: usize, motion: &mut [f64], low_passes: usize) {
        let Some(bends) = self.0.get(first..first + motion.len()) else {
            return;
        };
        let &[a, b, c, ..] = &*motion else {
            return;
        };
        let beside_even = low_passes as f64 * BESIDE_EVEN;
        let mut near = [a, b, c];
        for (i, bend) in bends.iter().enumerate() {
            if i > 1 && i + 1 < motion.len() {
                near = [near[1], near[2], motion[i + 1]];
            }
            let bent = bend.before * (near[0] - near[1]) + bend.after * (near[2] - near[1]);
            motion[i] += (bend.mean + beside_even) * bent;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_show_the_mean_of_a_parabola_over_their_rows() {
        let at = |t: f64| 1.0 + 2.0 * t - 30.0 * t * t;
        let (period, group) = (1e-3, 4);
        let rows: Vec<f64> = (0..24).map(|row| period * f64::from(row)).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let time: Vec<f64> = rows.chunks(group).map(mean).collect();
        let spread = period * period * (group * group - 1) as f64 / 12.0;
        let mut averaging = Averaging::default();
        averaging.add_window(&time, &vec![spread; time.len()]);
        let mut shown: Vec<f64> = time.iter().map(|t| at(*t)).collect();
        averaging.show(0, &mut shown, 0);
        for (rows, shown) in rows.chunks(group).zip(shown) {
            let positions: Vec<f64> = rows.iter().map(|t| at(*t)).collect();
            assert!((shown - mean(&positions)).abs() < 1e-12);
        }
    }
}
