//! What a command has to say, for people and for programs.

use crate::failure::Failure;
use serde_json::Value;
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
    /// Why a part of what was asked is missing, if it is.
    pub amiss: Option<Failure>,
}

impl Answer {
    /// Writes it to where it belongs.
    ///
    /// # Errors
    /// [`Failure::Write`] if that cannot be written; a reader that has gone away is no failure.
    pub fn give(&self, json: Option<&JsonTo>) -> Result<(), Failure> {
        let pretty = match &self.json {
            Value::Array(lines) => lines.iter().map(|line| format!("{line}\n")).collect(),
            whole => format!("{whole:#}\n"),
        };
        let text = match json {
            Some(JsonTo::StandardOutput) => &pretty,
            Some(JsonTo::File(path)) => {
                std::fs::write(path, &pretty).map_err(Failure::write(path))?;
                &self.text
            }
            None => &self.text,
        };
        let mut out = std::io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::write("standard output")(error))
            }
            _ => Ok(()),
        }
    }
}
