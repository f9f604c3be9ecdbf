//! What a command has to say, for people and for programs.

use crate::failure::Failure;
use serde_json::{Number, Value};
use std::convert::Infallible;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// Where JSON goes.
#[derive(Clone, Debug, PartialEq)]
pub enum JsonTo {
    /// Standard output, alone.
    StandardOutput,
    /// A file; the text still goes to standard output.
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

/// The result of a command, in two forms.
#[derive(Debug, Default)]
pub struct Answer {
    /// For people, lines ended.
    pub text: String,
    /// For programs; an array is written as JSON lines, one an element.
    pub json: Value,
    /// Why parts of what was asked are missing.
    pub amiss: Vec<Failure>,
}

impl Answer {
    /// Writes it to where it belongs, and adds to what is missing what cannot be written; a reader that has gone away is no
    /// failure.
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
        // The text comes first: whatever becomes of a file, it is there.
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                self.amiss.push(Failure::write("standard output")(error));
            }
            _ => {}
        }
        if let Some(JsonTo::File(path)) = json
            && let Err(error) = std::fs::write(path, &pretty)
        {
            self.amiss.push(Failure::write(path)(error));
        }
    }
}

/// Digits of a number in JSON: more than anything here is known to, and fewer than rounding leaves dust in.
const DIGITS: usize = 12;

/// Rounds every number in it that is not whole to [`DIGITS`].
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

/// A number of single precision as a person would write it.
pub fn short(value: f32) -> f64 {
    // What a float is written as reads back as a number.
    value.to_string().parse().unwrap_or(f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_have_no_dust() {
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
