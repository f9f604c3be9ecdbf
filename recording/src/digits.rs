//! Formats measured numbers for messages.

/// Significant digits of a measured number in a message.
const SIGNIFICANT: i32 = 4;

/// `value` rounded to four significant digits.
#[expect(clippy::cast_possible_truncation, reason = "an exponent")]
pub(crate) fn short(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let places = SIGNIFICANT - 1 - value.abs().log10().floor() as i32;
    // Rounding through text gives decimal digits. A product with a power of ten would leave rounding errors.
    let places = usize::try_from(places).unwrap_or(0);
    format!("{value:.places$}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn four_significant_digits_are_kept_at_any_scale() {
        assert_eq!(short(0.000_699_999_999_999_992_3), 0.0007);
        assert_eq!(short(-12.345_678), -12.35);
        assert_eq!(short(1_234_567.8), 1_234_568.0);
        assert_eq!(short(0.0), 0.0);
        assert!(short(f64::NAN).is_nan());
        assert_eq!(short(5e-324), 5e-324);
    }
}
