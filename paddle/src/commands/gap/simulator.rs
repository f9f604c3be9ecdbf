//! Writes a corrected model as a file for another simulator.

use crate::failure::Failure;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use export::{Exported, Format, Model, exported};
use gap::model_file::LeftOut;
use gap::{ModelFile, Outcome};
use recording::Recording;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Parser of a format's name. The help lists all formats.
pub fn format() -> impl TypedValueParser<Value = Format> {
    let known =
        Format::ALL.map(|format| PossibleValue::new(format.name()).help(format.description()));
    PossibleValuesParser::new(known).try_map(|name| name.parse::<Format>())
}

/// A destination: `FORMAT=FILE`, or `FORMAT` for a file called `corrected` in the working folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// Format of the file.
    pub format: Format,
    /// Path of the file.
    pub path: PathBuf,
}

impl FromStr for Destination {
    type Err = export::UnknownFormat;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, path) = match text.split_once('=') {
            Some((name, path)) => (name, Some(path)),
            None => (text, None),
        };
        let format: Format = name.parse()?;
        let path = match path {
            Some(path) => path.into(),
            None => Path::new("corrected").with_extension(format.extension()),
        };
        Ok(Self { format, path })
    }
}

/// A corrected model in the units of simulators.
pub struct Corrected {
    model: Model,
    of_moments: Vec<LeftOut>,
}

impl Corrected {
    /// Converts the model of `file`, which was read from `path`.
    ///
    /// # Errors
    /// Returns [`Failure::ModelFile`] for unknown effects and invalid numbers, and [`Failure::NotSi`] for positions in
    /// degrees.
    pub fn of_file(file: &ModelFile, path: &Path, is_linear: bool) -> Result<Self, Failure> {
        let apart = file.apart();
        let (corrected, of_moments) = apart.map_err(|cause| Failure::ModelFile {
            path: path.to_owned(),
            cause,
        })?;
        if corrected.model.angle_rad != 1.0 {
            return Err(Failure::NotSi(path.to_owned()));
        }
        let stem = path.file_stem().map(|stem| stem.to_string_lossy());
        let model = Model {
            name: stem.map_or_else(|| "paddle".into(), |stem| stem.into_owned()),
            device: corrected.device(),
            is_linear,
        };
        Ok(Self { model, of_moments })
    }

    /// Converts the model that a diagnosis of `recording` in `folder` found.
    ///
    /// # Errors
    /// Returns the errors of [`Self::of_file`] and of [`check_units`].
    pub fn of_outcome(
        folder: &Path,
        recording: &Recording,
        outcome: &Outcome,
    ) -> Result<Self, Failure> {
        check_units(folder, recording)?;
        let file = ModelFile::new(&outcome.model, recording);
        let mut found = Self::of_file(&file, folder, recording.units.is_length())?;
        if !recording.title.trim().is_empty() {
            found.model.name = recording.title.trim().to_owned();
        }
        Ok(found)
    }

    /// Writes the model in `format`.
    pub fn written(&self, format: Format) -> Written {
        let of_moments = self.of_moments.iter().map(ToString::to_string).collect();
        Written {
            exported: exported(&self.model, format),
            of_moments,
        }
    }
}

/// Checks that a model of `recording` has the units of simulators.
///
/// # Errors
/// Returns [`Failure::NotSi`] if positions are neither in rad nor in m.
pub fn check_units(folder: &Path, recording: &Recording) -> Result<(), Failure> {
    match recording.units.is_si() {
        true => Ok(()),
        false => Err(Failure::NotSi(folder.to_owned())),
    }
}

/// An exported model, and the parts that the file does not contain.
pub struct Written {
    /// The exported file and the parts that it omits or approximates.
    pub exported: Exported,
    /// Effects that apply only at one time of a recording.
    of_moments: Vec<String>,
}

impl Written {
    /// The omitted and approximated parts as text, one line each.
    pub fn lacks(&self) -> String {
        let mut said = String::new();
        // Writing to a String cannot fail.
        for (part, how) in &self.exported.approximated {
            let _ = writeln!(said, "approximated: {}: {how}", part.name());
        }
        if !self.exported.left_out.is_empty() {
            let names = self.left_out().join(", ");
            let _ = writeln!(said, "not expressed in this format: {names}");
        }
        for moment in &self.of_moments {
            let _ = writeln!(said, "left out: {moment}");
        }
        said
    }

    /// The same list as JSON, with the text of the file.
    pub fn json(&self) -> Value {
        let Exported {
            text, approximated, ..
        } = &self.exported;
        let approximated = approximated
            .iter()
            .map(|(part, how)| json!({ "name": part.name(), "how": how }));
        json!({
            "format": 1,
            "text": text,
            "approximated": approximated.collect::<Vec<_>>(),
            "left_out": self.left_out(),
            "of_moments": self.of_moments,
        })
    }

    fn left_out(&self) -> Vec<&'static str> {
        self.exported
            .left_out
            .iter()
            .map(|part| part.name())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_destination_without_a_file_is_called_after_its_format() {
        let path = |text: &str| {
            text.parse::<Destination>()
                .map(|destination| destination.path)
        };
        assert_eq!(path("mjcf"), Ok("corrected.xml".into()));
        assert_eq!(path("python=a=b.py"), Ok("a=b.py".into()));
        assert!(path("sdf=a").is_err());
    }
}
