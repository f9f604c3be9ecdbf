//! Figures that are equal on every machine.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::table::row;
use crate::{Failure, output};

/// Columns of a line of text.
const WIDTH: usize = 120;
const MILLI: f64 = 1e3;

/// Measures the figures.
pub struct Exact {
    program: PathBuf,
    scratch: PathBuf,
}

impl Exact {
    /// Creates the measurement with the command line at `program`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if its output folder cannot be created.
    pub fn new(program: &Path) -> Result<Self, Failure> {
        let scratch = program.with_file_name("figures");
        if scratch.exists() {
            fs::remove_dir_all(&scratch).map_err(|e| Failure::file(&scratch, e))?;
        }
        fs::create_dir_all(&scratch).map_err(|e| Failure::file(&scratch, e))?;
        Ok(Self {
            program: program.to_owned(),
            scratch,
        })
    }

    /// The figures with the name `name`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the name is unknown or if the program fails.
    pub fn table(&self, name: &str) -> Result<String, Failure> {
        match name {
            "gap-2018" => self.gap_2018(),
            "filter" => self.filter(),
            "report-2018" => self.report_2018(),
            other => Err(Failure::NoFigures(other.into())),
        }
    }

    fn text(&self, arguments: &str) -> Result<String, Failure> {
        output(
            Command::new(&self.program)
                .args(arguments.split(' '))
                .current_dir(&self.scratch),
        )
    }

    fn json(&self, arguments: &str) -> Result<Value, Failure> {
        let text = self.text(&format!("{arguments} --json -"))?;
        serde_json::from_str(&text).map_err(|e| Failure::Json(arguments.into(), e))
    }

    /// The verdict of the diagnosis on the lab's Simulink model.
    fn gap_2018(&self) -> Result<String, Failure> {
        if !self.scratch.join("lab-2018").exists() {
            self.text("sim lab --recording lab-2018")?;
        }
        let said = self.text("gap diagnose lab-2018")?;
        let mut paragraphs = said.split("\n\n");
        // Warnings are printed before the verdict.
        let verdict = paragraphs.next().and_then(|first| first.lines().last());
        let verdict = verdict.unwrap_or_default();
        let place = paragraphs.next().unwrap_or_default();
        // The gap of the prediction without a model is left out.
        let place = place
            .split("\nWithout any model")
            .next()
            .unwrap_or_default();
        let mut quote = String::new();
        let mut line = ">".to_owned();
        for word in format!("{verdict}. {place}").split_whitespace() {
            if line.chars().count() + 1 + word.chars().count() > WIDTH {
                let _ = writeln!(quote, "{line}");
                line = ">".into();
            }
            let _ = write!(line, " {word}");
        }
        Ok(format!("{quote}{line}\n"))
    }

    /// Effect of a low-pass on the position.
    fn filter(&self) -> Result<String, Failure> {
        let answer = self.json("sim filter")?;
        let cases = answer["cases"].as_array().map_or(&[][..], Vec::as_slice);
        let mut table = row(&[
            "sensor",
            "low-pass",
            "torque noise, mN m rms",
            "largest stable derivative gain, mN m s/°",
        ]);
        table.push_str("|---|---|---|---|\n");
        for case in cases {
            let cutoff_hz = case["cutoff_hz"].as_f64().unwrap_or_default();
            let cutoff = match cutoff_hz > 0.0 {
                true => format!("{cutoff_hz:.0} Hz"),
                false => "none".to_owned(),
            };
            let milli = |key: &str| {
                case[key]
                    .as_f64()
                    .map_or("none".into(), |v| two_digits(MILLI * v))
            };
            let sensor = case["sensor"].as_str().unwrap_or_default();
            let noise = milli("torque_noise_nm");
            table.push_str(&row(&[
                sensor,
                &cutoff,
                &noise,
                &milli("largest_stable_kd_nm_s_per_deg"),
            ]));
        }
        Ok(table)
    }

    /// The encoder rows of the report, with the simulated values.
    fn report_2018(&self) -> Result<String, Failure> {
        let answer = self.json("reproduce")?;
        let rows = answer["rows"].as_array().map_or(&[][..], Vec::as_slice);
        let mut table = row(&["row of the report", "report", "ours", "bar"]);
        table.push_str("|---|---|---|---|\n");
        for found in rows {
            let name = found["name"].as_str().unwrap_or_default();
            if !name.starts_with("encoder") {
                continue;
            }
            let unit = found["unit"].as_str().unwrap_or_default();
            let value = |of: &Value| match of.as_f64() {
                Some(number) => format!("{number:.2} {unit}").replace(" °", "°"),
                None => of.as_str().unwrap_or("").to_owned(),
            };
            let bar = match found["bar"].as_array().map(Vec::as_slice) {
                Some([low, high]) if low != high => format!("{} to {}", value(low), value(high)),
                Some([low, _]) => value(low),
                _ => "none".into(),
            };
            table.push_str(&row(&[
                name,
                &value(&found["report"]),
                &value(&found["ours"]),
                &bar,
            ]));
        }
        Ok(table)
    }
}

/// Formats a number with two significant digits.
fn two_digits(value: f64) -> String {
    let digits = (1 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32).clamp(0, 9);
    format!("{value:.0$}", digits as usize)
}

#[cfg(test)]
mod tests {
    use super::two_digits;

    #[test]
    fn numbers_have_two_significant_digits() {
        let written = [0.779, 0.1211, 18.02, 0.0].map(two_digits);
        assert_eq!(written, ["0.78", "0.12", "18", "0.000000000"]);
    }
}
