//! One quantity of a log: a column, or a formula of columns, with its unit.

use crate::error::ImportError;
use crate::log::{Column, Log};
use crate::unit;
use formula::Formula;

/// The user's choice: `NAME`, `NAME:UNIT`, `FORMULA` or `FORMULA:UNIT`.
#[derive(Clone, Debug)]
pub(crate) enum Choice<'a> {
    Column {
        column: &'a Column,
        /// The unit written after the name.
        unit: Option<String>,
    },
    Formula {
        formula: Box<Formula>,
        /// The columns in the order of the formula's names.
        columns: Vec<&'a Column>,
        unit: Option<String>,
    },
}

impl<'a> Choice<'a> {
    /// Finds the columns of `text` in `log`.
    ///
    /// # Errors
    ///
    /// [`ImportError`] for unknown names and invalid formulas.
    pub fn of(text: &str, log: &'a Log) -> Result<Self, ImportError> {
        let column = |name: &str, unit: Option<&str>| {
            log.find(name).map(|at| Self::Column {
                column: &log.columns[at],
                unit: unit.map(str::to_owned),
            })
        };
        let whole = column(text, None);
        if !matches!(whole, Err(ImportError::NoColumn { .. })) {
            return whole;
        }
        let (body, unit) = match text.rsplit_once(':') {
            Some((body, unit)) if is_unit(unit) => (body, Some(unit.trim())),
            _ => (text, None),
        };
        let named = column(body, unit);
        let is_formula = body.contains(['+', '-', '*', '/', '^', '(', ')', '{'])
            || body.trim().parse::<f64>().is_ok();
        if !is_formula || !matches!(named, Err(ImportError::NoColumn { .. })) {
            return named;
        }
        let formula = Formula::parse(body).map_err(|why| ImportError::Formula {
            text: body.to_owned(),
            why,
        })?;
        let columns = formula
            .names()
            .iter()
            .map(|name| log.find(name).map(|at| &log.columns[at]));
        Ok(Self::Formula {
            columns: columns.collect::<Result<_, _>>()?,
            unit: unit.map(str::to_owned),
            formula: Box::new(formula),
        })
    }

    /// Its unit: the written one, that of the column, or that at the end of its name.
    pub fn unit(&self) -> Option<&str> {
        match self {
            Self::Column { column, unit } => unit
                .as_deref()
                .or(column.unit.as_deref())
                .or_else(|| unit::of_name(column.bare())),
            Self::Formula { unit, .. } => unit.as_deref(),
        }
    }

    /// Its name, for display.
    pub fn name(&self) -> &str {
        match self {
            Self::Column { column, .. } => column.name.trim(),
            Self::Formula { formula, .. } => formula.text(),
        }
    }

    /// Its values row by row. NaN for an empty cell.
    ///
    /// # Errors
    ///
    /// [`ImportError::Text`].
    pub fn values(&self, log: &Log) -> Result<Vec<f64>, ImportError> {
        match self {
            Self::Column { column, .. } => numbers(column, log),
            Self::Formula {
                formula, columns, ..
            } => {
                let columns = columns.iter().map(|column| held(column, log));
                let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>()?;
                let row = |at: usize| columns.iter().map(|column| column[at]).collect::<Vec<_>>();
                Ok((0..log.rows()).map(|at| formula.value(&row(at))).collect())
            }
        }
    }
}

/// The values of a numeric column.
pub(crate) fn numbers(column: &Column, log: &Log) -> Result<Vec<f64>, ImportError> {
    match &column.cells {
        crate::log::Cells::Text(cells) => Err(ImportError::Text {
            log: log.name.clone(),
            column: column.name.clone(),
            cell: cells
                .iter()
                .find(|cell| !cell.is_empty())
                .cloned()
                .unwrap_or_default(),
        }),
        _ => Ok(column.values().unwrap_or_default().into_owned()),
    }
}

/// The values of a numeric column. An empty cell takes the previous value.
pub(crate) fn held(column: &Column, log: &Log) -> Result<Vec<f64>, ImportError> {
    let mut last = f64::NAN;
    let held = numbers(column, log)?.into_iter().map(|value| {
        if !value.is_nan() {
            last = value;
        }
        last
    });
    Ok(held.collect())
}

/// True if the text after a colon is a unit and not part of a name.
fn is_unit(text: &str) -> bool {
    let text = text.trim();
    unit::parse(text).is_some()
        || (!text.is_empty()
            && text.len() <= 8
            && !text.contains(['(', ')', '+', '*', '^', '[', ']']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_of_columns_has_the_usual_signs_row_by_row() {
        let log = Log {
            name: "a.csv".into(),
            columns: vec![
                Column::numbers("sp", vec![1.0, 2.0]),
                Column::numbers("q[2]", vec![3.0, -3.0]),
            ],
            notes: Vec::new(),
        };
        let values = |text: &str| Choice::of(text, &log).unwrap().values(&log).unwrap();
        assert_eq!(values("-{q[2]}^2"), [-9.0, -9.0]);
        assert_eq!(values("2*-{q[2]}^2 + sp"), [-17.0, -16.0]);
        let milli = values("1e3*sp:rad");
        assert_eq!(milli, [1000.0, 2000.0]);
    }
}
