//! The README states the Rust version that cargo requires.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The value of a line `key = "value"`.
fn stated(manifest: &str, key: &str) -> Option<String> {
    manifest.lines().find_map(|line| {
        let value = line.strip_prefix(key)?.trim().strip_prefix('=')?;
        Some(value.trim().trim_matches('"').to_owned())
    })
}

#[test]
fn the_readme_states_the_required_rust_version() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let version = stated(&manifest, "rust-version").unwrap();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let said = format!("Rust {version} or newer");
    assert!(readme.contains(&said), "the README does not say: {said}");
}

#[test]
fn every_package_requires_the_same_rust_version() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let members = stated(&manifest, "members").unwrap();
    let members = members.trim_matches(['[', ']']).split(", ");
    for member in members {
        let path = root().join(member.trim_matches('"')).join("Cargo.toml");
        let text = fs::read_to_string(&path).unwrap();
        let inherits = text
            .lines()
            .any(|line| line == "rust-version.workspace = true");
        assert!(
            inherits,
            "{} does not take the workspace's rust-version",
            path.display()
        );
    }
}
