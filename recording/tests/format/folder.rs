//! A recording on disk that is removed after the test.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use recording::{Error, Recording};

pub struct Folder(PathBuf);

impl Folder {
    pub fn empty() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let name = format!(
            "recording-{}-{}",
            std::process::id(),
            COUNT.fetch_add(1, Ordering::Relaxed)
        );
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn with(self, file: &str, bytes: impl AsRef<[u8]>) -> Self {
        fs::write(self.0.join(file), bytes).unwrap();
        self
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn read(&self) -> Result<Recording, Error> {
        Recording::read(&self.0)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // It does not matter if the folder is already gone.
        let _ = fs::remove_dir_all(&self.0);
    }
}
