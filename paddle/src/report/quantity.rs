//! Formats numbers with readable units: degrees for radians, milliseconds for short times.

/// Significant digits of a number in a sentence.
const DIGITS: i32 = 2;
/// A number below this size in its own unit is shown in thousandths of the unit.
const SMALL: f64 = 0.1;
/// Largest number of decimals of a standard deviation.
const FINEST: i32 = 8;
/// Powers of ten within which a number is written without an exponent.
const PLAIN: std::ops::Range<i32> = -5..7;

/// The unit in which numbers of a given size are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    /// Factor from the unit of the recording format to this unit.
    pub factor: f64,
    /// The unit as it is written after the number. It includes a leading space where one belongs.
    suffix: String,
}

impl Display {
    /// The unit for numbers of about `size` in `unit`.
    pub fn of(unit: &str, size: f64) -> Self {
        let small = size.abs() < SMALL && size != 0.0;
        let (factor, suffix) = match unit {
            "rad" => (1f64.to_degrees(), "°".into()),
            "deg" | "°" => (1.0, "°".into()),
            "deg/s" | "°/s" => (1.0, " °/s".into()),
            "deg/s²" | "°/s²" => (1.0, " °/s²".into()),
            "rad/s" => (1f64.to_degrees(), " °/s".into()),
            "rad/s²" => (1f64.to_degrees(), " °/s²".into()),
            "s" | "m" | "N m" | "N" | "A" | "V" | "m/s" if small => (1e3, format!(" m{unit}")),
            // All rates in the effect library are relative, so they are shown in per cent.
            "1/s" => (1e2, " % per second".into()),
            "1" | "" => (1.0, String::new()),
            _ => (1.0, format!(" {unit}")),
        };
        Self { factor, suffix }
    }

    /// The unit without a number, as for an axis.
    pub fn unit(&self) -> &str {
        match self.suffix.trim_start() {
            "°" => "degrees",
            unit => unit,
        }
    }

    /// Formats `value`, in the unit of the recording format, without its unit.
    pub fn number(&self, value: f64) -> String {
        significant(value * self.factor, DIGITS)
    }

    /// Formats `value`, in the unit of the recording format, with its unit.
    pub fn show(&self, value: f64) -> String {
        format!(
            "{}{}",
            significant(value * self.factor, DIGITS),
            self.suffix
        )
    }

    /// Formats `value` ± one standard deviation, rounded to the first digits of the deviation. Without a known deviation
    /// only the value is given.
    pub fn show_with_std(&self, value: f64, std: Option<f64>) -> String {
        let value = value * self.factor;
        let Some(std) = std.map(|std| std * self.factor) else {
            return format!("{}{}", significant(value, DIGITS + 1), self.suffix);
        };
        let decimals = DIGITS - 1 - power_of_ten(std, DIGITS);
        let [value, std] = [value, std].map(|v| match FINEST >= decimals {
            true => signed(v, format!("{:.*}", decimals.max(0) as usize, v.abs())),
            false => significant(v, DIGITS + 1),
        });
        match self.suffix.as_str() {
            "" => format!("{value} ± {std}"),
            suffix => format!("({value} ± {std}){suffix}"),
        }
    }

    /// Formats both ends of a range with the unit.
    pub fn show_range(&self, from: f64, to: f64) -> String {
        // The number of decimals is large enough to distinguish the ends.
        let width = (to - from).abs() * self.factor;
        let decimals = (DIGITS - 1 - power_of_ten(width, DIGITS)).clamp(0, 6) as usize;
        let end = |value: f64| {
            let value = value * self.factor;
            signed(value, format!("{:.decimals$}", value.abs()))
        };
        let unit = match self.suffix.as_str() {
            "°" => "°",
            _ => "",
        };
        format!("{}{unit} to {}{}", end(from), end(to), self.suffix)
    }
}

/// Formats a number in a suitable unit.
pub fn show(value: f64, unit: &str) -> String {
    Display::of(unit, value).show(value)
}

/// Formats a share in whole per cent.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    format!("{} %", signed(percent, format!("{:.0}", percent.abs())))
}

/// Formats a share with two decimals.
pub fn hundredths(share: f64) -> String {
    signed(share, format!("{:.2}", share.abs()))
}

/// Power of ten of the first digit after rounding to `digits` digits. It is 0 for zero and for numbers that are not finite.
fn power_of_ten(value: f64, digits: i32) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    let power = value.abs().log10().floor() as i32;
    let unit = 10f64.powi(power - digits + 1);
    ((value.abs() / unit).round() * unit * (1.0 + f64::EPSILON))
        .log10()
        .floor() as i32
}

/// Formats `value` with `digits` significant digits and keeps trailing zeros.
fn significant(value: f64, digits: i32) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let power = power_of_ten(value, digits);
    signed(
        value,
        match PLAIN.contains(&power) {
            true => format!("{:.*}", (digits - 1 - power).max(0) as usize, value.abs()),
            false => format!("{:.*e}", digits as usize - 1, value.abs()),
        },
    )
}

/// Adds a Unicode minus sign, unless the number is printed as zero.
fn signed(value: f64, magnitude: String) -> String {
    let zero = magnitude.parse() == Ok(0.0);
    match value < 0.0 && !zero {
        true => format!("−{magnitude}"),
        false => magnitude,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_shown_in_degrees_and_short_times_in_milliseconds() {
        assert_eq!(show(0.01, "rad"), "0.57°");
        assert_eq!(show(-0.5, "rad/s"), "−29 °/s");
        assert_eq!(show(-29.0, "deg/s"), "−29 °/s");
        assert_eq!(show(0.0031, "s"), "3.1 ms");
        assert_eq!(show(2.0, "s"), "2.0 s");
        assert_eq!(show(0.05, "1/s"), "5.0 % per second");
        assert_eq!(show(1.4, "1"), "1.4");
        assert_eq!(show(0.0, "m"), "0.0 m");
    }

    #[test]
    fn a_share_that_rounds_to_zero_has_no_sign() {
        assert_eq!([percent(-0.001), hundredths(-0.001)], ["0 %", "0.00"]);
        assert_eq!([percent(-0.12), hundredths(-0.12)], ["−12 %", "−0.12"]);
    }

    #[test]
    fn rounding_up_to_the_next_power_keeps_the_number_of_digits() {
        assert_eq!(show(0.0999, "N m s/rad"), "0.10 N m s/rad");
        assert_eq!(show(9.96, "1"), "10");
        assert_eq!(show(4.0e-9, "N m s/rad"), "4.0e-9 N m s/rad");
    }

    #[test]
    fn a_value_has_the_decimals_of_its_deviation() {
        let plain = Display::of("1", 1.4);
        assert_eq!(plain.show_with_std(1.4127, Some(0.0512)), "1.413 ± 0.051");
        assert_eq!(plain.show_with_std(1.4127, None), "1.41");
        let short = Display::of("s", 0.003);
        assert_eq!(
            short.show_with_std(0.0031, Some(0.0004)),
            "(3.10 ± 0.40) ms"
        );
    }

    #[test]
    fn the_ends_of_a_range_are_distinguishable() {
        assert_eq!(
            Display::of("Hz", 24.0).show_range(23.61, 24.4),
            "23.61 to 24.40 Hz"
        );
        let angle = Display::of("rad", 0.6);
        assert_eq!(angle.show_range(-0.61, 0.6), "−35° to 34°");
    }
}
