//! A torque that fades sooner than anything else changes. The masses receive its whole impulse at once. What it has not yet
//! delivered is subtracted where the true state is needed.

/// The part of a drive's torque that fades exponentially, by the acceleration that it causes.
///
/// Let τ be the lag and a the acceleration at the start of the step. A free mass then has v' = a exp(−t/τ). The sum
/// v + τ a exp(−t/τ) stays constant, and x − τ² a exp(−t/τ) grows evenly with that sum. Neither depends on τ, so that a step
/// may be as long as the other forces allow. The change of the other forces within τ is neglected: relative to τ a, it is as
/// large as τ is relative to their own time constant.
pub(super) struct Fading<const N: usize> {
    lag_s: f64,
    /// At the start of the step. Zero for each number of the state that is no velocity.
    acceleration: [f64; N],
}

impl<const N: usize> Fading<N> {
    /// From the rates of a state under the whole drive, and under the drive without its fading part.
    pub(super) fn of(lag_s: f64, under_all: &[f64; N], under_rest: &[f64; N]) -> Self {
        Self {
            lag_s,
            acceleration: core::array::from_fn(|i| under_all[i] - under_rest[i]),
        }
    }

    /// What the fading torque has yet to add to the true state, `t_s` after the start of the step. Each position is followed by
    /// its velocity in the state.
    #[inline]
    fn remaining(&self, t_s: f64) -> [f64; N] {
        let left_s = self.lag_s * (-t_s / self.lag_s).exp();
        core::array::from_fn(|i| {
            let of_position = self
                .acceleration
                .get(i + 1)
                .map_or(0.0, |a| -self.lag_s * a);
            left_s * (self.acceleration[i] + of_position)
        })
    }

    /// The state with the whole impulse, from the true state at the start of the step.
    #[inline]
    pub(super) fn given(&self, x: &[f64; N]) -> [f64; N] {
        let remaining = self.remaining(0.0);
        core::array::from_fn(|i| x[i] + remaining[i])
    }

    /// The true state `t_s` after the start of the step, from the state with the whole impulse.
    #[inline]
    pub(super) fn seen(&self, given: &[f64; N], t_s: f64) -> [f64; N] {
        let remaining = self.remaining(t_s);
        core::array::from_fn(|i| given[i] - remaining[i])
    }

    /// The rate of the true state, from the rate of the state with the whole impulse.
    #[inline]
    pub(super) fn seen_rate(&self, rate: &[f64; N], t_s: f64) -> [f64; N] {
        let left = (-t_s / self.lag_s).exp();
        core::array::from_fn(|i| rate[i] + left * self.acceleration[i])
    }
}
