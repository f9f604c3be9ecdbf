//! `cargo xtask book`: builds the documentation as a book.

use std::process::Command;

use crate::{Failure, run};

/// Builds the book with `mdbook`, which is not part of this repository.
pub fn build() -> Result<(), Failure> {
    if Command::new("mdbook").arg("--version").output().is_err() {
        return Err(Failure::NoBook);
    }
    run(Command::new("mdbook")
        .arg("build")
        .current_dir(firmware_build::root()))
}
