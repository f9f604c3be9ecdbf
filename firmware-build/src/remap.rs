//! Replaces local paths in the compiler's output.
//!
//! Panic messages and debug information contain the names of source files. The flags are set in the environment, because
//! profiles and configuration files cannot replace flags from the environment. Flags that are already set are kept.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Separator of the flags, because a flag may contain a space (see cargo's environment variables).
const SEPARATOR: &str = "\u{1f}";
const ENCODED: &str = "CARGO_ENCODED_RUSTFLAGS";

/// Cargo's environment variable with the flags that are already set, and with the flags that replace paths.
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

/// Source folders with their replacement names. The compiler tries the last entry first.
fn replacements(root: &Path, cargo_home: Option<&Path>) -> Vec<(PathBuf, &'static str)> {
    let registries = cargo_home.map(|home| home.join("registry/src"));
    let entries = registries.and_then(|folder| fs::read_dir(folder).ok());
    // The folder name is a hash of the registry's address, which differs between mirrors.
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
    fn every_source_folder_has_a_name_that_is_equal_on_all_machines() {
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
