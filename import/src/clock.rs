//! Converts the times of a log to seconds.

use crate::error::ImportError;
use crate::log::{Cells, Column};
use crate::unit::{self, Quantity};
use chrono::{DateTime, NaiveDateTime, NaiveTime};

/// Formats of date and time in logs.
const DATES: [&str; 7] = [
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d/%m/%Y %H:%M:%S%.f",
    "%Y%m%dT%H%M%S%.f",
    "%d-%b-%Y %H:%M:%S%.f",
];
/// Nanoseconds per day.
const DAY_NS: i64 = 86_400_000_000_000;
/// Numbers from these on are times since 1970, in the year 2001 or later, in s, ms, µs or ns.
const SINCE_1970: [(f64, f64, &str); 4] = [
    (1e18, 1e-9, "ns"),
    (1e15, 1e-6, "us"),
    (1e12, 1e-3, "ms"),
    (1e9, 1.0, "s"),
];

/// Times in s, and how they were interpreted.
pub(crate) struct Times {
    /// Time since the first row, s. NaN for an empty cell.
    pub seconds: Vec<f64>,
    /// Time of the first row, s. 0 for dates.
    pub origin_s: f64,
    /// The unit, for display.
    pub unit: String,
    /// True if the unit was guessed from the magnitude of the numbers only.
    pub is_guessed: bool,
}

/// Returns true if a text is a date or a time of day.
pub(crate) fn is_stamp(cell: &str) -> bool {
    let cell = cell.trim();
    cell.len() >= 8
        && cell.starts_with(|c: char| c.is_ascii_digit())
        && cell.contains(':')
        && nanoseconds(cell).is_some()
}

/// Nanoseconds since 1970, or since midnight for a time of day. Without a time zone it is UTC.
fn nanoseconds(cell: &str) -> Option<i64> {
    let cell = cell.trim().replace(',', ".");
    if let Ok(stamp) = DateTime::parse_from_rfc3339(&cell) {
        return stamp.timestamp_nanos_opt();
    }
    let dates = DATES
        .iter()
        .find_map(|date| NaiveDateTime::parse_from_str(&cell, date).ok());
    if let Some(stamp) = dates {
        return stamp.and_utc().timestamp_nanos_opt();
    }
    let time = NaiveTime::parse_from_str(&cell, "%H:%M:%S%.f").ok()?;
    (time - NaiveTime::MIN).num_nanoseconds()
}

/// The times of `column` in the stated unit. Without one, the unit is taken from the name or guessed from the numbers.
///
/// # Errors
///
/// [`ImportError::Time`] for text that is not a time, [`ImportError::Unit`] for a unit that is not one of time.
#[expect(
    clippy::cast_precision_loss,
    reason = "differences of stamps are small"
)]
pub(crate) fn times(
    column: &Column,
    stated: Option<&str>,
    log: &str,
) -> Result<Times, ImportError> {
    let unit = stated
        .or(column.unit.as_deref())
        .or_else(|| unit::of_name(column.bare()));
    let si = match unit {
        Some(unit) => match unit::parse(unit) {
            Some((Quantity::Time, si)) => Some((si, unit.to_owned())),
            _ if stated.is_some() => {
                return Err(ImportError::Unit {
                    unit: unit.to_owned(),
                    role: "time",
                    examples: "s, ms, us, ns",
                });
            }
            _ => None,
        },
        None => None,
    };
    let is_guessed = si.is_none();
    Ok(match &column.cells {
        Cells::Text(cells) => {
            let mut day = 0;
            let mut before = None;
            let mut stamps = Vec::with_capacity(cells.len());
            for cell in cells {
                if cell.trim().is_empty() {
                    stamps.push(None);
                    continue;
                }
                let bad = || ImportError::Time {
                    log: log.to_owned(),
                    column: column.name.clone(),
                    cell: cell.chars().take(40).collect(),
                };
                let stamp = nanoseconds(cell).ok_or_else(bad)?;
                // A time of day restarts at midnight.
                let is_of_day = stamp < DAY_NS;
                if is_of_day && before.is_some_and(|before| before - stamp > DAY_NS / 2) {
                    day += 1;
                }
                before = Some(stamp);
                stamps.push(Some(stamp + if is_of_day { day * DAY_NS } else { 0 }));
            }
            Times {
                seconds: since_first(&stamps, 1e-9),
                origin_s: 0.0,
                unit: "date and time".into(),
                is_guessed: false,
            }
        }
        Cells::Whole(cells) => {
            let first = cells
                .iter()
                .flatten()
                .next()
                .map_or(0.0, |first| *first as f64);
            let steps = cells.iter().flatten().zip(cells.iter().flatten().skip(1));
            let steps: Vec<f64> = steps.map(|(a, b)| (b - a) as f64).collect();
            let (si, unit) = si.unwrap_or_else(|| guessed_by_magnitude(first, steps));
            Times {
                seconds: since_first(cells, si),
                origin_s: first * si,
                unit,
                is_guessed,
            }
        }
        Cells::Numbers(cells) => {
            let filled = || cells.iter().filter(|cell| !cell.is_nan());
            let first = filled().next().copied().unwrap_or(0.0);
            let steps: Vec<f64> = filled().zip(filled().skip(1)).map(|(a, b)| b - a).collect();
            let (si, unit) = si.unwrap_or_else(|| guessed_by_magnitude(first, steps));
            let seconds = cells
                .iter()
                .map(|cell| tidy((cell - first) * si, first))
                .collect();
            Times {
                seconds,
                origin_s: first * si,
                unit,
                is_guessed,
            }
        }
    })
}

/// Integer time stamps as seconds since the first one.
#[expect(
    clippy::cast_precision_loss,
    reason = "differences of stamps are small"
)]
fn since_first(stamps: &[Option<i64>], si: f64) -> Vec<f64> {
    let first = stamps.iter().flatten().next().copied().unwrap_or(0);
    let second = |stamp: &Option<i64>| {
        stamp.map_or(f64::NAN, |stamp| tidy((stamp - first) as f64 * si, 1.0))
    };
    stamps.iter().map(second).collect()
}

/// Removes digits that the subtraction of the first time has created. A time without subtraction is unchanged.
fn tidy(seconds: f64, first: f64) -> f64 {
    const PER_SECOND: f64 = 1e10;
    if first == 0.0 || seconds.is_nan() {
        return seconds;
    }
    (seconds * PER_SECOND).round() / PER_SECOND
}

/// Guesses the unit from the magnitude of the times and their steps: times since 1970, or integer counts per row.
fn guessed_by_magnitude(first: f64, mut steps: Vec<f64>) -> (f64, String) {
    if let Some((_, si, name)) = SINCE_1970.iter().find(|(least, ..)| first >= *least) {
        return (*si, format!("{name} since 1970"));
    }
    steps.retain(|step| *step > 0.0);
    steps.sort_unstable_by(f64::total_cmp);
    let median = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    // A device is never logged once per second or more slowly, because its control would not be visible.
    let unit = match median {
        step if step >= 2e4 => (1e-9, "ns"),
        step if step >= 100.0 => (1e-6, "us"),
        step if step >= 0.5 => (1e-3, "ms"),
        _ => (1.0, "s"),
    };
    (unit.0, unit.1.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(column: &Column) -> (Vec<f64>, String) {
        let times = times(column, None, "a").expect("times");
        (times.seconds, times.unit)
    }

    #[test]
    fn units_of_time_are_found_by_name_and_magnitude() {
        let numbers = |name: &str, cells: &[f64]| seconds(&Column::numbers(name, cells.to_vec()));
        let close = |found: &[f64], wanted: &[f64]| {
            found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        for (name, cells, wanted) in [
            ("timestamp [s]", [69.49005, 69.49075], [0.0, 0.0007]),
            ("t", [0.0, 0.001], [0.0, 0.001]),
            ("millis", [12.0, 14.0], [0.0, 0.002]),
            ("t_ms", [0.5, 0.75], [0.0, 0.00025]),
            ("t", [0.0, 1000.0], [0.0, 0.001]),
            ("stamp", [1.7e9, 1.7e9 + 0.25], [0.0, 0.25]),
        ] {
            let (found, unit) = numbers(name, &cells);
            assert!(close(&found, &wanted), "{name}: {found:?} {unit}");
        }
        let whole = Column::new(
            "t".into(),
            Cells::Whole(vec![
                Some(1_700_000_000_000_000_001),
                Some(1_700_000_000_001_000_001),
            ]),
        );
        assert_eq!(seconds(&whole).0, [0.0, 0.001]);
    }

    #[test]
    fn dates_and_times_of_day_are_read() {
        for (cells, wanted) in [
            (
                ["2026-01-02T03:04:05.500Z", "2026-01-02T03:04:05.501Z"],
                0.001,
            ),
            (["2026-01-02 03:04:05,5", "2026-01-02 03:04:06"], 0.5),
            (["02.01.2026 03:04:05.000", "02.01.2026 03:04:05.010"], 0.01),
            (["23:59:59.999", "00:00:00.000"], 0.001),
        ] {
            let column = Column::new("t".into(), Cells::Text(cells.map(str::to_owned).into()));
            assert_eq!(seconds(&column).0, [0.0, wanted], "{cells:?}");
        }
    }
}
