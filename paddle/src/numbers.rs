//! Parses numbers on the command line. The error message states the allowed values.

use std::str::FromStr;

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text, |_| true, "a number")
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0, "a number above 0")
}

/// A setting of the control core, which checks the range itself.
pub fn setting(text: &str) -> Result<f32, String> {
    let value = finite(text)? as f32;
    if value.is_finite() {
        Ok(value)
    } else {
        Err("it must be a number of the control core, at most 3.4e38".into())
    }
}

/// A non-negative integer, such as a seed.
pub fn whole(text: &str) -> Result<u64, String> {
    whole_from(text, 0)
}

/// A positive integer, such as a count.
pub fn count(text: &str) -> Result<u64, String> {
    whole_from(text, 1)
}

fn number(text: &str, holds: impl Fn(f64) -> bool, wanted: &str) -> Result<f64, String> {
    parsed(text)
        .filter(|value: &f64| value.is_finite() && holds(*value))
        .ok_or_else(|| format!("it must be {wanted}"))
}

fn whole_from(text: &str, least: u64) -> Result<u64, String> {
    parsed(text)
        .filter(|value| *value >= least)
        .ok_or_else(|| format!("it must be a whole number, {least} or above"))
}

fn parsed<T: FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}
