//! How far a gap shrinks, with an interval.

/// Resamplings of the windows for an interval.
const RESAMPLINGS: usize = 400;

/// `(rms before − rms after) / (rms reference − rms floor)` of squares by window, none of them below the floor, with its 95 %
/// interval; 1 where the reference is not above it.
pub(crate) fn shrink(before: &[f64], after: &[f64], floor: &[f64], reference: &[f64]) -> [f64; 3] {
    resampled(before.len(), |sum| {
        let [b, a, f, r] = [before, after, floor, reference].map(|squares| sum(squares).sqrt());
        if r > f {
            (b.max(f) - a.max(f)) / (r - f)
        } else {
            1.0
        }
    })
}

/// Stretches into which a recording is cut, and how many of them, drawn at random, stand for another recording. `docs/diagnosis.md` has
/// the trial.
const STRETCHES: usize = 8;
const STRETCHES_OF_ANOTHER: usize = 2;
/// Standard deviation of the logarithm of a floor: the noise is known to some 15 %.
const FLOOR_ERROR: f64 = 0.15;

/// 95 % interval of the shrink on another recording of the device with the same kind of motion.
pub(crate) fn on_another(before: &[f64], after: &[f64], floor: &[f64]) -> [f64; 2] {
    let windows = before.len();
    let stretches = windows.min(STRETCHES);
    if stretches == 0 {
        return [0.0; 2];
    }
    let sums: Vec<[f64; 3]> = (0..stretches)
        .map(|k| {
            let own = k * windows / stretches..(k + 1) * windows / stretches;
            [before, after, floor].map(|squares| squares[own.clone()].iter().sum())
        })
        .collect();
    let mut random = Picks::new();
    let mut values: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            let mut drawn = [0.0; 3];
            for _ in 0..STRETCHES_OF_ANOTHER {
                let stretch = sums[random.below(stretches)];
                drawn = core::array::from_fn(|i| drawn[i] + stretch[i]);
            }
            let [b, a, f] = drawn.map(f64::sqrt);
            let floor = f * (FLOOR_ERROR * random.normal()).exp();
            if b > f.max(floor) {
                ((b - a.max(f)) / (b - floor)).min(1.0)
            } else {
                1.0
            }
        })
        .collect();
    values.sort_by(f64::total_cmp);
    [quantile(&values, 0.025), quantile(&values, 0.975)]
}

/// A number made of sums over `n` windows, with its 95 % interval by resampling them (Efron, Annals of Statistics 7,
/// 1979).
pub(crate) fn resampled(n: usize, value: impl Fn(&dyn Fn(&[f64]) -> f64) -> f64) -> [f64; 3] {
    if n == 0 {
        return [0.0; 3];
    }
    let whole = value(&|squares| squares.iter().sum());
    let mut random = Picks::new();
    let mut picked = vec![0; n];
    let mut values: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            for pick in &mut picked {
                *pick = random.below(n);
            }
            value(&|squares| picked.iter().map(|&w| squares[w]).sum())
        })
        .collect();
    values.sort_by(f64::total_cmp);
    [whole, quantile(&values, 0.025), quantile(&values, 0.975)]
}

/// Of sorted values.
fn quantile(values: &[f64], share: f64) -> f64 {
    values[((values.len() - 1) as f64 * share).round() as usize]
}

/// A fixed multiplicative generator: the interval of a recording is always the same.
pub(crate) struct Picks(u64);

impl Picks {
    pub(crate) fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    /// A number from 0 to `n` - 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }

    /// A standard normal one, as the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        const STEPS: usize = 1 << 20;
        let uniform = |picks: &mut Self| picks.below(STEPS) as f64 / STEPS as f64;
        (0..12).map(|_| uniform(self)).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_on_another_recording_is_as_wide_as_stretches_differ() {
        let before = vec![1.0; 80];
        let floor = vec![1e-6; 80];
        let even = vec![0.04; 80];
        let uneven: Vec<f64> = (0..80).map(|w| if w < 40 { 0.01 } else { 0.07 }).collect();
        let [low, high] = on_another(&before, &even, &floor);
        assert!(
            high - low < 0.01 && (0.79..0.81).contains(&low),
            "{low} {high}"
        );
        let [low, high] = on_another(&before, &uneven, &floor);
        assert!(low < 0.75 && high > 0.89, "{low} {high}");
    }

    #[test]
    fn a_gap_that_is_closed_to_a_floor_has_an_interval_by_the_floor() {
        let [low, high] = on_another(&[1.0; 40], &[1e-4; 40], &[1e-4; 40]);
        assert!(high == 1.0 && (0.99..0.9999).contains(&low), "{low} {high}");
    }
}
