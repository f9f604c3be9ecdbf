//! The result of a command, as text for the user and as JSON for programs.

use crate::failure::Failure;
use serde_json::{Number, Value};
use std::convert::Infallible;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// The destination of the JSON output.
#[derive(Clone, Debug, PartialEq)]
pub enum JsonTo {
    /// JSON goes to standard output, and the text is not printed.
    StandardOutput,
    /// JSON goes to this file, and the text still goes to standard output.
    File(PathBuf),
}

impl std::str::FromStr for JsonTo {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "-" => Self::StandardOutput,
            file => Self::File(file.into()),
        })
    }
}

/// The result of a command as text and as JSON.
#[derive(Debug, Default)]
pub struct Answer {
    /// Text for the user. Every line ends with a newline.
    pub text: String,
    /// JSON for programs. An array is written as JSON lines, one line per element.
    pub json: Value,
    /// Failures that left parts of the result missing.
    pub problems: Vec<Failure>,
}

impl Answer {
    /// Writes the result to its destinations. A destination that cannot be written adds a failure to the list of problems. A
    /// closed pipe at standard output is not a failure.
    pub fn give(&mut self, json: Option<&JsonTo>) {
        rounded(&mut self.json);
        let pretty = match &self.json {
            Value::Array(lines) => lines.iter().map(|line| format!("{line}\n")).collect(),
            whole => format!("{whole:#}\n"),
        };
        let text = match json {
            Some(JsonTo::StandardOutput) => &pretty,
            _ => &self.text,
        };
        // The text is printed first, so that it appears even if a file cannot be written.
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                self.problems.push(Failure::write("standard output")(error));
            }
            _ => {}
        }
        if let Some(JsonTo::File(path)) = json
            && let Err(error) = std::fs::write(path, &pretty)
        {
            self.problems.push(Failure::write(path)(error));
        }
    }
}

/// Significant digits of a number in JSON. No result is known to more digits, and rounding errors are smaller.
const DIGITS: usize = 12;

/// Rounds every number in `value` that is not an integer to [`DIGITS`] significant digits.
pub fn rounded(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => {
            let written = number
                .as_f64()
                .map(|exact| format!("{exact:.*e}", DIGITS - 1));
            let short = written.and_then(|text| text.parse().ok());
            if let Some(short) = short.and_then(Number::from_f64) {
                *number = short;
            }
        }
        Value::Array(values) => values.iter_mut().for_each(rounded),
        Value::Object(values) => values.values_mut().for_each(rounded),
        _ => {}
    }
}

/// Converts a single-precision number to the double with the same shortest decimal form.
pub fn short(value: f32) -> f64 {
    // The decimal form of a finite f32 always parses as an f64.
    value.to_string().parse().unwrap_or(f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn json_numbers_are_rounded_to_the_stated_digits() {
        let mut value =
            json!({ "a": [0.1 + 0.2, 1e-15 / 3.0, 12, null], "b": 77.600_000_000_000_01 });
        rounded(&mut value);
        assert_eq!(
            value.to_string(),
            r#"{"a":[0.3,3.33333333333e-16,12,null],"b":77.6}"#
        );
        assert_eq!(json!(short(0.0008)).to_string(), "0.0008");
    }
}
