//! Paths of the documentation pages and of cargo's target folder.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Failure;

/// Paths of the pages relative to the root, in reading order: pages for beginners first.
///
/// # Errors
/// Returns [`Failure::File`] if a folder cannot be read.
pub fn pages() -> Result<Vec<PathBuf>, Failure> {
    let mut pages = Vec::new();
    for folder in ["docs", "docs/effects"] {
        let path = firmware_build::root().join(folder);
        let entries = fs::read_dir(&path).map_err(|e| Failure::file(&path, e))?;
        for entry in entries {
            let name = entry.map_err(|e| Failure::file(&path, e))?.file_name();
            let page = Path::new(folder).join(name);
            if page.extension().is_some_and(|extension| extension == "md") {
                pages.push(page);
            }
        }
    }
    pages.sort();
    let first = ["README.md", "CONTRIBUTING.md"].map(PathBuf::from);
    Ok(first.into_iter().chain(pages).collect())
}

/// Cargo's target folder for this repository.
pub fn target_folder() -> PathBuf {
    let root = firmware_build::root();
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |f| root.join(f))
}

#[cfg(test)]
mod tests {
    use std::fs;

    const MOST_LINES: usize = 150;
    const MOST_WORDS: usize = 80;

    #[test]
    fn the_readme_and_its_paragraphs_are_short() {
        let readme = fs::read_to_string(firmware_build::root().join("README.md")).unwrap();
        let lines = readme.lines().count();
        assert!(lines <= MOST_LINES, "{lines} lines");
        for paragraph in readme.split("\n\n") {
            let lines = paragraph.lines();
            // Tables, lists and program output do not count.
            let prose = lines.filter(|line| !line.starts_with(['|', '-', '`', '<', '>', ' ']));
            let words = prose.flat_map(str::split_whitespace).count();
            assert!(words <= MOST_WORDS, "{words} words: {paragraph}");
        }
    }
}
