//! Statistics of columns.

/// Least and largest value.
pub(crate) fn extremes(column: &[f64]) -> (f64, f64) {
    column
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        })
}

/// True if all values are equal.
pub(crate) fn is_constant<T: PartialEq>(column: &[T]) -> bool {
    column.windows(2).all(|pair| pair[0] == pair[1])
}

const SIXTH: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];

/// Sixth differences of evenly spaced samples. They suppress a motion that is sampled some 25 times per period, so that
/// noise remains.
pub fn sixth_differences(column: &[f64]) -> impl Iterator<Item = f64> {
    let difference = |seven: &[f64]| seven.iter().zip(SIXTH).map(|(x, by)| by * x).sum();
    column.windows(SIXTH.len()).map(difference)
}

/// Share of all steps between samples that count as the smallest ones.
const SMALL: f64 = 0.1;

/// A typical one of the smallest non-zero steps between samples. 0 if there are none.
pub(crate) fn smallest_step(column: &[f64]) -> f64 {
    let steps = column.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    quantile(steps.filter(|step| *step > 0.0).collect(), SMALL)
}

/// Median magnitude of a sixth difference of white noise over its standard deviation: 0.6745 √(12 over 6).
const MEDIAN_DIFFERENCE: f64 = 20.5;

/// Standard deviation of the noise in evenly spaced samples of a motion.
pub(crate) fn noise(column: &[f64]) -> f64 {
    median(sixth_differences(column).map(f64::abs).collect()) / MEDIAN_DIFFERENCE
}

/// The quantile `part` of `values`. 0 if there are none.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]
pub(crate) fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = ((values.len() - 1) as f64 * part).round() as usize;
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

/// The median. 0 if there are no values.
pub(crate) fn median(values: Vec<f64>) -> f64 {
    quantile(values, 0.5)
}
