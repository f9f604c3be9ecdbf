//! Files that a command leaves behind.

use crate::failure::Failure;
use crate::plot::PlotError;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A folder to be filled, what was put there, and what could not be. What cannot be written costs nothing else.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: Vec<PathBuf>,
    lost: Vec<Failure>,
}

impl Folder {
    /// The folder `path`, made as soon as a file is put into it.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            files: Vec::new(),
            lost: Vec::new(),
        }
    }

    /// Puts a file of this name and text into it; the name may lead through further folders.
    pub fn put(&mut self, name: impl AsRef<Path>, text: &str) {
        let path = self.path.join(name);
        match leave(&path, text) {
            Ok(()) => self.files.push(path),
            Err(failure) => self.lost.push(failure),
        }
    }

    /// Puts a drawing into it, if that could be drawn.
    pub fn draw(&mut self, name: impl AsRef<Path>, drawing: Result<String, PlotError>) {
        match drawing {
            Ok(text) => self.put(name, &text),
            Err(error) => self.lost.push(error.into()),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The files that were put there, in their order.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Why others are not there.
    pub fn lost(self) -> Vec<Failure> {
        self.lost
    }
}

/// Writes `text` to the file `path`, in place of what there was; its folder is made if it is not there.
///
/// # Errors
/// [`Failure::Write`].
pub fn leave(path: &Path, text: &str) -> Result<(), Failure> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(Failure::write(parent))?;
    }
    std::fs::write(path, text).map_err(Failure::write(path))
}

/// Text of a CSV file of columns of one length.
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

/// Steps of a logged number in its unit: finer than the noise of every sensor.
const STEPS_PER_UNIT: f64 = 1e9;

/// `value` without digits that mean nothing.
pub fn logged(value: f64) -> f64 {
    // Adding 0 makes -0 to 0.
    (value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT + 0.0
}
