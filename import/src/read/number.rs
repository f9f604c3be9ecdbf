//! Parses numbers in logs.

/// The decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimal {
    Point,
    Comma,
}

/// Texts that mean a missing value.
const NOTHING: [&str; 10] = [
    "", "nan", "na", "n/a", "null", "none", "-", "--", "#n/a", "nil",
];

/// True if a cell means a missing value.
pub(super) fn is_nothing(cell: &str) -> bool {
    let cell = cell.trim();
    cell.len() <= 4 && NOTHING.contains(&cell.to_lowercase().as_str())
}

/// The number in a cell. `None` for other text.
pub(super) fn number(cell: &str, decimal: Decimal) -> Option<f64> {
    let cell = cell.trim();
    let value = match decimal {
        Decimal::Point => cell.parse().ok(),
        Decimal::Comma if cell.contains(',') => {
            // With a decimal comma, points group thousands.
            cell.replace('.', "").replace(',', ".").parse().ok()
        }
        Decimal::Comma => cell.parse().ok(),
    };
    let value = value.or(match cell {
        "true" | "True" | "TRUE" => Some(1.0),
        "false" | "False" | "FALSE" => Some(0.0),
        _ => None,
    });
    // `inf` and `nan` are treated as text.
    value.filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_points_and_commas_are_read() {
        use Decimal::{Comma, Point};
        for (cell, decimal, value) in [
            ("1.5", Point, Some(1.5)),
            (" -2e-3 ", Point, Some(-2e-3)),
            ("1,5", Point, None),
            ("1,5", Comma, Some(1.5)),
            ("1.234,5", Comma, Some(1234.5)),
            ("3", Comma, Some(3.0)),
            ("inf", Point, None),
            ("True", Point, Some(1.0)),
        ] {
            assert_eq!(number(cell, decimal), value, "{cell}");
        }
        assert!(is_nothing(" NaN ") && is_nothing("") && !is_nothing("0"));
    }
}
