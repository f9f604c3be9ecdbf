//! A log as a table of named columns.

use crate::error::ImportError;
use crate::unit;
use std::borrow::Cow;

/// A table of columns of equal length. Cells can be empty, for example if several rates were joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Name of the file, for messages and names of runs.
    pub name: String,
    /// The columns in the order of the file.
    pub columns: Vec<Column>,
    /// What was left out or assumed during reading.
    pub notes: Vec<String>,
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the file, including a unit in brackets.
    pub name: String,
    /// Unit stated by the file.
    pub unit: Option<String>,
    /// One cell per row.
    pub cells: Cells,
}

/// Cells of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Numbers. An empty cell is NaN.
    Numbers(Vec<f64>),
    /// Integers that a float cannot hold exactly, such as nanoseconds since 1970.
    Whole(Vec<Option<i64>>),
    /// Text. An empty cell is an empty string.
    Text(Vec<String>),
}

impl Column {
    /// A column of numbers. A unit in brackets is taken from the name.
    pub fn numbers(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self::new(name.into(), Cells::Numbers(values))
    }

    /// A column of any cells. A unit in brackets is taken from the name.
    pub fn new(name: String, cells: Cells) -> Self {
        let unit = split_unit(&name).1.map(str::to_owned);
        Self { name, unit, cells }
    }

    /// The name without a unit in brackets.
    pub fn bare(&self) -> &str {
        split_unit(&self.name).0
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        match &self.cells {
            Cells::Numbers(cells) => cells.len(),
            Cells::Whole(cells) => cells.len(),
            Cells::Text(cells) => cells.len(),
        }
    }

    /// True if there are no cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cells as numbers, with NaN for empty cells. `None` for text.
    pub fn values(&self) -> Option<Cow<'_, [f64]>> {
        match &self.cells {
            Cells::Numbers(cells) => Some(Cow::Borrowed(cells)),
            #[expect(
                clippy::cast_precision_loss,
                reason = "a value, not a stamp, is asked for"
            )]
            Cells::Whole(cells) => Some(Cow::Owned(
                cells
                    .iter()
                    .map(|cell| cell.map_or(f64::NAN, |whole| whole as f64))
                    .collect(),
            )),
            Cells::Text(_) => None,
        }
    }

    /// True if it has at least two different values.
    pub fn is_live(&self) -> bool {
        match &self.cells {
            Cells::Numbers(cells) => differ(cells.iter().filter(|cell| !cell.is_nan())),
            Cells::Whole(cells) => differ(cells.iter().flatten()),
            Cells::Text(cells) => differ(cells.iter().filter(|cell| !cell.is_empty())),
        }
    }
}

fn differ<T: PartialEq>(mut cells: impl Iterator<Item = T>) -> bool {
    cells
        .next()
        .is_some_and(|first| cells.any(|cell| cell != first))
}

impl Log {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Column::len)
    }

    /// Index of the column with this name. In order of preference, `name` is the whole name, the name without unit, either
    /// in another case, or the unique ending after a point or slash.
    ///
    /// # Errors
    ///
    /// [`ImportError::NoColumn`] and [`ImportError::Ambiguous`].
    pub fn find(&self, name: &str) -> Result<usize, ImportError> {
        let name = name.trim();
        let low = name.to_lowercase();
        let ends = |column: &Column| {
            let (whole, bare) = (column.name.to_lowercase(), column.bare().to_lowercase());
            let after = |text: &str| {
                text.strip_suffix(low.as_str())
                    .is_some_and(|rest| rest.ends_with(['.', '/']))
            };
            after(&whole) || after(&bare)
        };
        let exact = |column: &Column| column.name.trim() == name;
        let bare = |column: &Column| column.bare() == name;
        let other_letters = |column: &Column| {
            column.name.trim().to_lowercase() == low || column.bare().to_lowercase() == low
        };
        let rules: [&dyn Fn(&Column) -> bool; 4] = [&exact, &bare, &other_letters, &ends];
        for rule in rules {
            let found: Vec<usize> = (0..self.columns.len())
                .filter(|at| rule(&self.columns[*at]))
                .collect();
            match found[..] {
                [] => {}
                [only] => return Ok(only),
                _ => {
                    let names = found.iter().map(|at| self.columns[*at].name.trim());
                    return Err(ImportError::Ambiguous {
                        log: self.name.clone(),
                        name: name.to_owned(),
                        found: listed(names),
                    });
                }
            }
        }
        let near = self.columns.iter().find(|column| {
            let bare = column.bare().to_lowercase();
            !low.is_empty() && (bare.contains(&low) || (!bare.is_empty() && low.contains(&bare)))
        });
        Err(ImportError::NoColumn {
            log: self.name.clone(),
            name: name.to_owned(),
            nearest: near.map(|column| column.name.trim().to_owned()),
            known: listed(self.columns.iter().map(|column| column.name.trim())),
        })
    }

    /// Names of the columns whose values change, for messages.
    pub fn live_names(&self) -> String {
        listed(
            self.columns
                .iter()
                .filter(|column| column.is_live())
                .map(|column| column.name.trim()),
        )
    }

    /// Names of the columns with a single value.
    pub fn frozen_names(&self) -> Vec<&str> {
        let frozen = self.columns.iter().filter(|column| !column.is_live());
        frozen.map(|column| column.name.trim()).collect()
    }
}

/// Largest number of names in a message.
const LISTED: usize = 24;

/// The names in one line.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    if names.is_empty() {
        return "none".into();
    }
    match names.len().checked_sub(LISTED) {
        Some(more @ 1..) => format!("{} and {more} more", names[..LISTED].join(", ")),
        _ => names.join(", "),
    }
}

/// Splits a name and the unit in brackets after it. `q[2]` and `led [0.0-1.0]` have no unit.
pub(crate) fn split_unit(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(inside) = name.strip_suffix(close)
            && let Some((bare, unit)) = inside.rsplit_once(open)
        {
            let unit = unit.trim();
            let is_apart = bare.ends_with(char::is_whitespace);
            if unit::parse(unit).is_some() {
                return (bare.trim_end(), Some(unit));
            }
            if is_apart && !bare.trim().is_empty() {
                return (bare.trim_end(), None);
            }
        }
    }
    (name, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_distinguished_from_an_index() {
        for (name, bare, unit) in [
            ("timestamp [s]", "timestamp", Some("s")),
            ("motor_torque [N.m]", "motor_torque", Some("N.m")),
            ("q[2]", "q[2]", None),
            ("led_0 [0.0-1.0]", "led_0", None),
            ("Winkel(°)", "Winkel", Some("°")),
            ("Kp ", "Kp", None),
            ("speed (deg/s)", "speed", Some("deg/s")),
        ] {
            assert_eq!(split_unit(name), (bare, unit), "{name}");
        }
    }

    #[test]
    fn a_column_is_found_by_its_shortest_unique_name() {
        let column = |name: &str| Column::numbers(name, vec![0.0]);
        let log = Log {
            name: "a".into(),
            columns: [
                "Time [s]",
                "/joint_states.elbow.position",
                "/joint_states.wrist.position",
            ]
            .map(column)
            .into(),
            notes: Vec::new(),
        };
        assert_eq!(log.find("time").unwrap(), 0);
        assert_eq!(log.find("elbow.position").unwrap(), 1);
        assert!(matches!(
            log.find("position"),
            Err(ImportError::Ambiguous { .. })
        ));
        assert!(matches!(
            log.find("torque"),
            Err(ImportError::NoColumn { .. })
        ));
    }
}
