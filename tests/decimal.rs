//! Compares the decimal conversions with those of the standard library.

use haptic_paddle::decimal::{Decimal, Fixed, parse};
use proptest::prelude::*;

#[test]
fn typical_numbers_are_parsed_as_by_the_standard_library() {
    for text in [
        "0", "-0", "0.05", "0.0003", "81.9", "1e3", "1.5e-6", "+7", ".5", "5.", "40000000", "1E2",
        "0.000585",
    ] {
        assert_eq!(parse(text), text.parse().ok(), "{text}");
    }
}

#[test]
fn text_that_is_not_a_number_is_refused() {
    for text in [
        "", "-", ".", "e3", "1e", "1e-", "1.2.3", "nan", "inf", "0x1", "1 ", "--1", "1e1e1", "kp",
    ] {
        assert_eq!(parse(text), None, "{text}");
    }
}

#[test]
fn numbers_of_any_size_can_be_formatted() {
    for (value, text) in [
        (0.05, "0.05"),
        (-0.0323, "-0.0323"),
        (1.0, "1"),
        (40.0, "40"),
        (1e6, "1000000"),
        (0.000_001_25, "0.00000125"),
        (3e-20, "3e-20"),
        (1.5e30, "15e29"),
        (f32::NAN, "nan"),
        (f32::NEG_INFINITY, "-inf"),
    ] {
        assert_eq!(Decimal(value).to_string(), text);
    }
    assert_eq!(Fixed(1e12, 3).to_string(), "1e12");
    assert_eq!(Fixed(-0.0001, 3).to_string(), "0.000");
    assert_eq!(Fixed(2.5, 0).to_string(), "3");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn six_digits_survive(digits in 1_u32..1_000_000, decimals in 0_i32..8, negative: bool) {
        let value = f64::from(digits) / 10_f64.powi(decimals) * if negative { -1.0 } else { 1.0 };
        let text = Decimal(value as f32).to_string();
        prop_assert_eq!(&text, &format!("{value}"));
        prop_assert_eq!(parse(&text), text.parse().ok());
    }

    #[test]
    fn parsing_is_accurate_to_the_last_bits(value in any::<f32>().prop_filter("normal", |v| v.is_normal())) {
        let read = parse(&format!("{value:e}")).unwrap();
        prop_assert!((read / value - 1.0).abs() < 1e-6, "{} {}", read, value);
        let shown: f32 = Decimal(value).to_string().parse().unwrap();
        prop_assert!((shown / value - 1.0).abs() < 6e-6, "{} {}", shown, value);
    }

    #[test]
    fn no_text_causes_a_panic(text in "[-+.e0-9]{0,80}") {
        if let (Some(read), Ok(expected)) = (parse(&text), text.parse::<f32>()) {
            prop_assert!(read == expected || (read / expected - 1.0).abs() < 1e-5 || expected.abs() < 1e-30, "{}", read);
        }
    }

    #[test]
    fn fixed_decimals_are_those_of_the_standard_library(thousandths in -1_000_000_i32..1_000_000) {
        let value = thousandths as f32 / 1000.0;
        prop_assert_eq!(Fixed(value, 3).to_string(), format!("{value:.3}"));
    }
}
