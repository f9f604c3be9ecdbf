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

/// A number made of sums over `n` windows, with its 95 % interval by resampling them (Efron, Annals of Statistics 7,
/// 1979).
pub(crate) fn resampled(n: usize, value: impl Fn(&dyn Fn(&[f64]) -> f64) -> f64) -> [f64; 3] {
    if n == 0 {
        return [0.0; 3];
    }
    let whole = value(&|squares| squares.iter().sum());
    // A fixed multiplicative generator: the interval of a recording is always the same.
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut picked = vec![0; n];
    let mut values: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            for pick in &mut picked {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                *pick = ((state >> 33) as usize) % n;
            }
            value(&|squares| picked.iter().map(|&w| squares[w]).sum())
        })
        .collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((RESAMPLINGS - 1) as f64 * share).round() as usize];
    [whole, at(0.025), at(0.975)]
}
