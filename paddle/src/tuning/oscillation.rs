//! Analyses the oscillation of a loop about its setpoint, cycle by cycle.

/// Cycles between upward crossings of a level.
#[derive(Clone, Debug, PartialEq)]
pub struct Oscillation {
    /// Period of each cycle, s.
    pub periods_s: Vec<f64>,
    /// Peak-to-peak position of each cycle, in the unit of the position.
    pub swings: Vec<f64>,
}

/// Smallest ratio of the last to the first peak-to-peak value of a sustained oscillation.
pub const SUSTAINED: f64 = 0.9;

impl Oscillation {
    /// The oscillation of `position` over `time_s` about `level`. Crossing times are interpolated between samples.
    pub fn about(level: f64, time_s: &[f64], position: &[f64]) -> Self {
        let beyond: Vec<_> = position.iter().map(|x| x - level).collect();
        let upward: Vec<_> = (1..beyond.len().min(time_s.len()))
            .filter(|&i| beyond[i - 1] < 0.0 && beyond[i] >= 0.0)
            .map(|i| {
                let share = beyond[i - 1] / (beyond[i - 1] - beyond[i]);
                (i, time_s[i - 1] + share * (time_s[i] - time_s[i - 1]))
            })
            .collect();
        let swing = |pair: &[(usize, f64)]| {
            let cycle = &beyond[pair[0].0..pair[1].0];
            let highest = cycle.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            highest - cycle.iter().copied().fold(f64::INFINITY, f64::min)
        };
        Self {
            periods_s: upward
                .windows(2)
                .map(|pair| pair[1].1 - pair[0].1)
                .collect(),
            swings: upward.windows(2).map(swing).collect(),
        }
    }

    /// The first `count` cycles.
    pub fn first(&self, count: usize) -> Self {
        let count = count.min(self.swings.len());
        Self {
            periods_s: self.periods_s[..count].to_vec(),
            swings: self.swings[..count].to_vec(),
        }
    }

    /// Mean period, s. Returns `None` without a cycle.
    pub fn period_s(&self) -> Option<f64> {
        let count = self.periods_s.len();
        (count > 0).then(|| self.periods_s.iter().sum::<f64>() / count as f64)
    }

    /// Last peak-to-peak value divided by the first. Returns 0 without a cycle.
    pub fn kept(&self) -> f64 {
        match (self.swings.first(), self.swings.last()) {
            (Some(first), Some(last)) if *first > 0.0 => last / first,
            _ => 0.0,
        }
    }

    /// Whether there are at least `cycles` cycles, and the first `cycles` of them do not decay.
    pub fn is_sustained(&self, cycles: usize) -> bool {
        self.swings.len() >= cycles && self.first(cycles).kept() >= SUSTAINED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swinging(damping_per_s: f64) -> Oscillation {
        let time: Vec<_> = (0..4000).map(|i| f64::from(i) * 0.35e-3).collect();
        let position: Vec<_> = time
            .iter()
            .map(|t| 10.0 - 9.0 * (-damping_per_s * t).exp() * (t * 70.0).cos())
            .collect();
        Oscillation::about(10.0, &time, &position)
    }

    #[test]
    fn the_period_of_a_sine_is_found() {
        let period_s = swinging(0.0).period_s().unwrap();
        assert!((period_s / (std::f64::consts::TAU / 70.0) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_decaying_oscillation_is_not_sustained() {
        assert!(swinging(0.0).is_sustained(10) && swinging(-1.0).is_sustained(10));
        assert!(!swinging(0.5).is_sustained(10));
        assert!(!swinging(0.0).is_sustained(1000));
        assert!(!Oscillation::about(0.0, &[0.0, 1.0], &[1.0, 1.0]).is_sustained(1));
    }
}
