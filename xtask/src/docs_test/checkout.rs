//! A clean copy of the files under version control, in which the commands of the documentation run.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Failure;

/// A clean copy of the repository. Its folder is always the same, and an unchanged file keeps its modification time, so that
/// cargo rebuilds only what changed.
pub struct Checkout {
    folder: PathBuf,
    files: BTreeSet<PathBuf>,
}

impl Checkout {
    /// Copies this repository, with its uncommitted changes, to `folder`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if git fails.
    pub fn new(folder: PathBuf) -> Result<Self, Failure> {
        let root = firmware_build::root();
        let listed = crate::output(Command::new("git").current_dir(root).args([
            "ls-files",
            "--cached",
            "--others",
            "--exclude-standard",
            "-z",
        ]))?;
        let names = listed.split('\0').filter(|name| !name.is_empty());
        let files = names.map(PathBuf::from);
        let files = files.filter(|name| root.join(name).is_file()).collect();
        Ok(Self { folder, files })
    }

    /// Path of the copy.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Copies the files that differ, and removes the files that do not belong to the repository.
    ///
    /// # Errors
    /// Returns a [`Failure`] for the first file that cannot be copied or removed.
    pub fn clean(&self) -> Result<(), Failure> {
        fs::create_dir_all(&self.folder).map_err(|e| Failure::file(&self.folder, e))?;
        self.remove_others(&self.folder)?;
        self.files.iter().try_for_each(|name| self.copy(name))
    }

    fn copy(&self, name: &Path) -> Result<(), Failure> {
        let from = firmware_build::root().join(name);
        let to = self.folder.join(name);
        let content = fs::read(&from).map_err(|e| Failure::file(&from, e))?;
        if fs::read(&to).is_ok_and(|there| there == content) {
            return Ok(());
        }
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent).map_err(|e| Failure::file(parent, e))?;
        }
        fs::copy(&from, &to).map_err(|e| Failure::file(&to, e))?;
        Ok(())
    }

    fn remove_others(&self, folder: &Path) -> Result<(), Failure> {
        let entries = fs::read_dir(folder).map_err(|e| Failure::file(folder, e))?;
        for entry in entries {
            let path = entry.map_err(|e| Failure::file(folder, e))?.path();
            let name = path.strip_prefix(&self.folder).unwrap_or(&path);
            let holds_files = self.files.iter().any(|file| file.starts_with(name));
            let removed = if path.is_dir() && holds_files {
                self.remove_others(&path)?;
                Ok(())
            } else if path.is_dir() {
                fs::remove_dir_all(&path)
            } else if holds_files {
                Ok(())
            } else {
                fs::remove_file(&path)
            };
            removed.map_err(|e| Failure::file(&path, e))?;
        }
        Ok(())
    }
}
