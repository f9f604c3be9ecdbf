//! Formulas of named quantities.

use crate::error::ImportError;
use exmex::{Express, FlatEx};

/// A formula that was compiled once and is evaluated for each row.
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    expression: FlatEx<f64>,
}

impl Formula {
    /// Compiles `text`: numbers, names, `+ - * / ^`, `sin`, `cos`, `tan`, `atan2`, `exp`, `ln`, `sqrt`, `abs`, `signum`, `min`,
    /// `max`, `floor`, `PI` and others of the crate `exmex`. Names that are no words stand in braces: `{q[2]}`.
    ///
    /// # Errors
    /// [`ImportError::Formula`].
    pub fn parse(text: &str) -> Result<Self, ImportError> {
        let expression = exmex::parse::<f64>(text).map_err(|error| ImportError::Formula {
            text: text.to_owned(),
            why: error.to_string(),
        })?;
        Ok(Self {
            text: text.to_owned(),
            expression,
        })
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names in it, in the order in which [`value`](Self::value) takes their values.
    pub fn names(&self) -> &[String] {
        self.expression.var_names()
    }

    /// Its value; NaN where it has none.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.expression.eval(values).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_takes_its_names_in_their_order() {
        let formula = Formula::parse("0.01*(sp-{q[2]})/15 + max(sp, 1)").expect("a formula");
        assert_eq!(formula.names(), ["q[2]", "sp"]);
        let value = formula.value(&[1.0, 4.0]);
        assert!((value - (0.01 * 3.0 / 15.0 + 4.0)).abs() < 1e-15, "{value}");
    }

    #[test]
    fn nonsense_is_an_error_and_no_panic() {
        for text in ["", "1+", "((", "a b", "sin", "{a", "]["] {
            let parsed = std::panic::catch_unwind(|| Formula::parse(text).is_err());
            assert!(parsed.is_ok(), "{text} panics");
        }
    }
}
