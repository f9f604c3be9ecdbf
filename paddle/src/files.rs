//! Output files of a command.

use crate::failure::Failure;
use crate::plot::PlotError;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// An output folder, the files written to it, and the files that could not be written. A file that cannot be written does
/// not prevent the others.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: Vec<PathBuf>,
    lost: Vec<Failure>,
}

impl Folder {
    /// The folder `path`, which is created when the first file is written.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            files: Vec::new(),
            lost: Vec::new(),
        }
    }

    /// Writes a file with this name and text. The name may contain subfolders.
    pub fn put(&mut self, name: impl AsRef<Path>, text: &str) {
        let path = self.path.join(name);
        match leave(&path, text) {
            Ok(()) => self.files.push(path),
            Err(failure) => self.lost.push(failure),
        }
    }

    /// Writes a drawing, if it could be drawn.
    pub fn draw(&mut self, name: impl AsRef<Path>, drawing: Result<String, PlotError>) {
        match drawing {
            Ok(text) => self.put(name, &text),
            Err(error) => self.lost.push(error.into()),
        }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The written files, in the order of writing.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Failures of the files that could not be written.
    pub fn lost(self) -> Vec<Failure> {
        self.lost
    }
}

/// Writes `text` to the file `path` and replaces an existing file. Creates the folder of the file if necessary.
///
/// # Errors
/// Returns [`Failure::Write`] if the file cannot be written.
pub fn leave(path: &Path, text: &str) -> Result<(), Failure> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(Failure::write(parent))?;
    }
    std::fs::write(path, text).map_err(Failure::write(path))
}

/// Text of a CSV file with columns of equal length.
pub fn csv(columns: &[(&str, &[f64])]) -> String {
    let names: Vec<_> = columns.iter().map(|(name, _)| *name).collect();
    let mut text = names.join(",") + "\n";
    let rows = columns.iter().map(|(_, column)| column.len()).min();
    for row in 0..rows.unwrap_or(0) {
        for (place, (_, column)) in columns.iter().enumerate() {
            let separator = if place > 0 { "," } else { "" };
            // Writing to a String cannot fail.
            let _ = write!(text, "{separator}{}", logged(column[row]));
        }
        text.push('\n');
    }
    text
}

/// Resolution of a logged number: steps per unit. The step is smaller than the noise of every sensor.
const STEPS_PER_UNIT: f64 = 1e9;

/// Rounds `value` to the resolution of a logged number.
pub fn logged(value: f64) -> f64 {
    // Adding 0 converts -0 to 0.
    (value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT + 0.0
}
