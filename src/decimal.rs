//! Decimal text of `f32` in single precision. The conversions of `core` are exact for every float, but need some 30 KiB of
//! flash.

use core::fmt;

/// Significant digits that [`Decimal`] writes. A number with this many digits is unchanged after it is parsed and written.
const SIGNIFICANT_DIGITS: u32 = 6;
/// Number of mantissa digits that are read. Further digits are below the resolution.
const MANTISSA_DIGITS: u32 = 9;
/// Largest exponent that is evaluated. Larger ones give 0 or overflow anyway.
const MAX_EXPONENT: i32 = 99;

/// Parses a number such as `-12.5` or `3e-4`. Returns `None` for other text.
///
/// The result is correctly rounded for up to seven digits and ten decimals. Otherwise the last bits may differ.
pub fn parse(text: &str) -> Option<f32> {
    let bytes = text.as_bytes();
    let (negative, bytes) = signed(bytes);
    let (mut mantissa, mut digits, mut read, mut exponent, mut point) = (0_u32, 0, 0, 0_i32, false);
    let mut rest = bytes;
    while let [byte, after @ ..] = rest {
        match byte {
            b'0'..=b'9' => {
                read += 1;
                if digits < MANTISSA_DIGITS {
                    mantissa = mantissa * 10 + u32::from(byte - b'0');
                    digits += u32::from(mantissa != 0);
                    exponent -= i32::from(point);
                } else {
                    exponent += i32::from(!point);
                }
            }
            b'.' if !point => point = true,
            b'e' | b'E' => break,
            _ => return None,
        }
        rest = after;
    }
    if read == 0 {
        return None;
    }
    if let [_, after @ ..] = rest {
        exponent += exponent_of(after)?;
    }
    let magnitude = scaled(mantissa as f32, exponent);
    Some(if negative { -magnitude } else { magnitude })
}

fn signed(bytes: &[u8]) -> (bool, &[u8]) {
    match bytes {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, bytes),
    }
}

fn exponent_of(bytes: &[u8]) -> Option<i32> {
    let (negative, digits) = signed(bytes);
    if digits.is_empty() {
        return None;
    }
    let exponent = digits.iter().try_fold(0, |exponent: i32, byte| {
        byte.is_ascii_digit()
            .then(|| (exponent * 10 + i32::from(byte - b'0')).min(MAX_EXPONENT))
    })?;
    Some(if negative { -exponent } else { exponent })
}

/// `value` times ten to the `exponent`, in steps whose power of ten is exact in `f32`.
fn scaled(mut value: f32, mut exponent: i32) -> f32 {
    const EXACT: i32 = 10;
    while exponent != 0 && value != 0.0 && value.is_finite() {
        let step = exponent.clamp(-EXACT, EXACT);
        let power = (0..step.abs()).fold(1.0, |power: f32, _| power * 10.0);
        value = if step < 0 {
            value / power
        } else {
            value * power
        };
        exponent -= step;
    }
    value
}

/// Displays a number with up to six significant digits and without trailing zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decimal(pub f32);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if !value.is_finite() {
            return not_finite(f, value);
        }
        if value == 0.0 {
            return f.write_str("0");
        }
        let (low, high) = (
            10_u32.pow(SIGNIFICANT_DIGITS - 1),
            10_u32.pow(SIGNIFICANT_DIGITS),
        );
        let mut decimals = 0;
        let mut digits = value.abs();
        while digits < low as f32 && decimals < MAX_EXPONENT {
            decimals += 1;
            digits = scaled(value.abs(), decimals);
        }
        while digits >= high as f32 {
            decimals -= 1;
            digits = scaled(value.abs(), decimals);
        }
        let mut digits = (digits + 0.5) as u32;
        while digits.is_multiple_of(10) {
            digits /= 10;
            decimals -= 1;
        }
        if value < 0.0 {
            f.write_str("-")?;
        }
        match decimals {
            1..=9 => fixed(f, digits, decimals as u32),
            0 => write!(f, "{digits}"),
            -9..=-1 if digits < 10_u32.pow((10 + decimals).unsigned_abs() - 1) => {
                write!(f, "{}", digits * 10_u32.pow(decimals.unsigned_abs()))
            }
            _ => write!(f, "{digits}e{}", -decimals),
        }
    }
}

/// Displays a number with a fixed number of decimals, up to nine. Large numbers are displayed like [`Decimal`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed(pub f32, pub u32);

impl fmt::Display for Fixed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, decimals) = *self;
        let digits = scaled(value.abs(), decimals as i32) + 0.5;
        if value.is_nan() || digits >= u32::MAX as f32 {
            return Decimal(value).fmt(f);
        }
        let digits = digits as u32;
        if value < 0.0 && digits != 0 {
            f.write_str("-")?;
        }
        fixed(f, digits, decimals)
    }
}

/// Writes `digits` with a decimal point before the last `decimals` of them.
fn fixed(f: &mut fmt::Formatter<'_>, digits: u32, decimals: u32) -> fmt::Result {
    match 10_u32.checked_pow(decimals) {
        None | Some(0 | 1) => write!(f, "{digits}"),
        Some(one) => write!(
            f,
            "{}.{:0width$}",
            digits / one,
            digits % one,
            width = decimals as usize
        ),
    }
}

fn not_finite(f: &mut fmt::Formatter<'_>, value: f32) -> fmt::Result {
    f.write_str(if value.is_nan() {
        "nan"
    } else if value < 0.0 {
        "-inf"
    } else {
        "inf"
    })
}
