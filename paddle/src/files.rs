//! Files that a command leaves behind.

use crate::failure::Failure;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A folder to be filled, and what was put there.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    files: Vec<PathBuf>,
}

impl Folder {
    /// The folder `path`, made if it is not there.
    ///
    /// # Errors
    /// [`Failure::Write`].
    pub fn make(path: &Path) -> Result<Self, Failure> {
        std::fs::create_dir_all(path).map_err(Failure::write(path))?;
        Ok(Self {
            path: path.to_owned(),
            files: Vec::new(),
        })
    }

    /// The folder `path` as [`Self::make`], refused if a recording is in it.
    ///
    /// # Errors
    /// [`Failure::HoldsRecording`], [`Failure::Write`].
    pub fn make_beside_recordings(path: &Path) -> Result<Self, Failure> {
        match path.join("recording.toml").exists() {
            true => Err(Failure::HoldsRecording(path.to_owned())),
            false => Self::make(path),
        }
    }

    /// Puts a file of this name and text into it; the name may lead through further folders.
    ///
    /// # Errors
    /// [`Failure::Write`].
    pub fn put(&mut self, name: impl AsRef<Path>, text: &str) -> Result<(), Failure> {
        let path = self.path.join(name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(Failure::write(parent))?;
        }
        std::fs::write(&path, text).map_err(Failure::write(&path))?;
        self.files.push(path);
        Ok(())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The files that were put there, in their order.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }
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
