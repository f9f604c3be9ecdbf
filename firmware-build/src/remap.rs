//! Paths of this machine, replaced in what the compiler writes.
//!
//! Panics and debug information name source files. Flags in the environment are the one place that neither a profile nor a
//! configuration replaces: those that are set there already are kept.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Between flags, since a flag may hold a space (cargo's environment variables).
const SEPARATOR: &str = "\u{1f}";
const ENCODED: &str = "CARGO_ENCODED_RUSTFLAGS";

/// The environment variable of cargo with the flags that are set and those that replace paths.
pub(crate) fn flags() -> [(&'static str, String); 1] {
    let set = env::var(ENCODED).map_or_else(
        |_| {
            let flags = env::var("RUSTFLAGS").unwrap_or_default();
            flags.split_whitespace().map(String::from).collect()
        },
        |flags| flags.split(SEPARATOR).map(String::from).collect::<Vec<_>>(),
    );
    let set = set.into_iter().filter(|flag| !flag.is_empty());
    let replaced = replacements(crate::root(), cargo_home().as_deref());
    let remaps = replaced
        .into_iter()
        .map(|(path, name)| format!("--remap-path-prefix={}={name}", path.display()));
    let flags: Vec<String> = set.chain(remaps).collect();
    [(ENCODED, flags.join(SEPARATOR))]
}

/// Folders with sources, each with the name that takes its place; the compiler tries the last one first.
fn replacements(root: &Path, cargo_home: Option<&Path>) -> Vec<(PathBuf, &'static str)> {
    let registries = cargo_home.map(|home| home.join("registry/src"));
    let entries = registries.and_then(|folder| fs::read_dir(folder).ok());
    // Named by a hash of the registry's address, which a mirror changes.
    let mut folders: Vec<PathBuf> = entries
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .collect();
    folders.sort();
    let registries = folders.into_iter().map(|folder| (folder, "registry"));
    let home = cargo_home.map(|home| (home.to_owned(), "cargo"));
    let root = [(root.to_owned(), "haptic-paddle")];
    root.into_iter().chain(home).chain(registries).collect()
}

fn cargo_home() -> Option<PathBuf> {
    let home = || Some(PathBuf::from(env::var_os("HOME")?).join(".cargo"));
    env::var_os("CARGO_HOME").map(PathBuf::from).or_else(home)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_folder_of_sources_has_a_name_that_no_machine_changes() {
        let home = env::temp_dir().join(format!("paddle-remap-{}", std::process::id()));
        let registry = home.join("registry/src/mirror-0123");
        fs::create_dir_all(&registry).unwrap();
        let replaced = replacements(Path::new("/a/checkout"), Some(&home));
        fs::remove_dir_all(&home).unwrap();
        let expected = [
            (PathBuf::from("/a/checkout"), "haptic-paddle"),
            (home, "cargo"),
            (registry, "registry"),
        ];
        assert_eq!(replaced, expected);
    }
}
