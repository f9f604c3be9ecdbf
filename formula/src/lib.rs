//! Formulas that a user writes with named quantities, for columns of a log and for torques of effects.

mod notation;

use exmex::{Express, FlatEx};

/// A compiled formula, which is evaluated for each row or step.
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    expression: FlatEx<f64>,
}

impl Formula {
    /// Compiles `text`. A formula may contain numbers such as `2`, `.5` and `1e-3`, names, the operators `+ - * / ^`, and
    /// the functions and constants `sin`, `cos`, `tan`, `atan2`, `exp`, `ln`, `sqrt`, `abs`, `signum`, `min`, `max`,
    /// `floor`, `PI` and others of the crate `exmex`. A name with special characters is written in braces: `{q[2]}`. A sign
    /// applies to the following power: `-x^2` is `-(x^2)`.
    ///
    /// # Errors
    /// Returns a short message if `text` is not a formula.
    pub fn parse(text: &str) -> Result<Self, String> {
        let usual = notation::for_exmex(text);
        let expression = exmex::parse::<f64>(&usual).map_err(|error| error.to_string())?;
        Ok(Self {
            text: text.to_owned(),
            expression,
        })
    }

    /// The text of the formula.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Names in the formula, in the order in which [`value`](Self::value) takes their values.
    pub fn names(&self) -> &[String] {
        self.expression.var_names()
    }

    /// Value of the formula. It is NaN where the formula is undefined.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.expression.eval(values).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_passed_in_the_order_of_the_names() {
        let formula = Formula::parse("0.01*(sp-{q[2]})/15 + max(sp, 1)").expect("a formula");
        assert_eq!(formula.names(), ["q[2]", "sp"]);
        let value = formula.value(&[1.0, 4.0]);
        assert!((value - (0.01 * 3.0 / 15.0 + 4.0)).abs() < 1e-15, "{value}");
    }

    #[test]
    fn a_sign_applies_to_the_following_power() {
        for (text, expected) in [
            ("-x^2", -9.0),
            (" - x ^ 2", -9.0),
            ("exp( -x^2)", (-9.0f64).exp()),
            ("2 - x", -1.0),
            ("2 - -x^2", 11.0),
            ("--x^2", 9.0),
            ("2*-x^2", -18.0),
            ("18/-x^2", -2.0),
            ("-x^2*2", -18.0),
            ("max(-x^2, -x)", -3.0),
            ("-max(x, 1)^2", -9.0),
            ("-(x - 1)^2", -4.0),
            ("(-x)^2", 9.0),
            ("x^-2", 1.0 / 9.0),
            ("-x^-2", -1.0 / 9.0),
            ("-2e-1*x", -0.6),
            ("x + 1.5E+2 - 1e1", 143.0),
            ("-(-x^2)", 9.0),
        ] {
            let value = Formula::parse(text).expect(text).value(&[3.0]);
            assert!((value - expected).abs() < 1e-12, "{text}: {value}");
        }
        let braced = Formula::parse("-{a-b}^2").expect("a name in braces");
        assert_eq!(braced.names(), ["a-b"]);
        assert!((braced.value(&[3.0]) + 9.0).abs() < 1e-12);
    }

    #[test]
    fn an_invalid_formula_is_an_error_and_does_not_panic() {
        for text in [
            "", "1+", "((", "a b", "sin", "{a", "][", "-", "2*-", "-(", "-{", "-^", "-°", "x^-",
        ] {
            let parsed = std::panic::catch_unwind(|| Formula::parse(text).is_err());
            assert!(parsed.is_ok(), "{text} panics");
        }
    }
}
