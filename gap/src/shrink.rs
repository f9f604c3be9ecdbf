//! The shrink of a gap with its confidence interval.

/// Number of bootstrap resamplings of the windows for a confidence interval.
const RESAMPLINGS: usize = 400;

/// The shrink `(rms before − rms after) / (rms reference − rms floor)` from sums of squares by window, with its 95 % interval. No rms
/// counts as less than the floor. The shrink is 1 if the reference is not above the floor.
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

/// 95 % limits of the ratio of the relative residual of a corrected model on another recording to that on its own recording;
/// `docs/diagnosis.md` describes their estimate.
const RESIDUAL_ON_ANOTHER: [f64; 2] = [0.3, 4.6];

/// 95 % interval of the shrink on another recording of the device with another excitation.
pub(crate) fn on_another(before: &[f64], after: &[f64], floor: &[f64]) -> [f64; 2] {
    let [before, after, floor] =
        [before, after, floor].map(|squares| squares.iter().sum::<f64>().sqrt());
    if before <= floor {
        return [0.0, 1.0];
    }
    let [least, most] = RESIDUAL_ON_ANOTHER.map(|factor| factor * after.max(floor));
    [most, least].map(|residual| ((before - residual) / (before - floor)).min(1.0))
}

/// The share of one cause in a `total` shrink, with its interval widened in proportion to that of the total on another recording.
pub(crate) fn part_on_another(
    [part, low, high]: [f64; 3],
    total: f64,
    [least, most]: [f64; 2],
) -> [f64; 3] {
    let share = if total > 0.0 { part / total } else { 0.0 };
    [part, low.min(share * least), high.max(share * most)]
}

/// A statistic of sums over `n` windows, with its 95 % interval by bootstrap (Efron, Annals of Statistics 7, 1979).
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

/// A quantile of sorted values.
fn quantile(values: &[f64], share: f64) -> f64 {
    values[((values.len() - 1) as f64 * share).round() as usize]
}

/// A linear congruential generator with a fixed seed. It gives the same interval for the same recording.
pub(crate) struct Picks(u64);

impl Picks {
    pub(crate) fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    /// A random number from 0 to `n` - 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_on_another_recording_is_wider_for_a_larger_residual() {
        let before = vec![1.0; 80];
        let floor = vec![1e-6; 80];
        let residual = |rms: f64| on_another(&before, &vec![rms * rms; 80], &floor);
        let [[little, high], [much, _]] = [0.01, 0.2].map(residual);
        assert!(high == 1.0 || high > 0.99, "{high}");
        assert!(
            (0.94..0.97).contains(&little) && (0.0..0.2).contains(&much),
            "{little} {much}"
        );
    }

    #[test]
    fn the_interval_of_a_gap_at_its_floor_depends_on_the_floor() {
        let [low, high] = on_another(&[1.0; 40], &[1e-4; 40], &[1e-4; 40]);
        assert!(high == 1.0 && (0.95..0.99).contains(&low), "{low} {high}");
    }

    #[test]
    fn the_interval_of_a_part_widens_with_that_of_the_whole() {
        let [part, low, high] = part_on_another([0.3, 0.29, 0.31], 0.9, [0.6, 0.99]);
        assert!(
            part == 0.3 && (low - 0.2).abs() < 1e-9 && (high - 0.33).abs() < 1e-9,
            "{low} {high}"
        );
    }
}
