//! The real recordings that lie beside the project are all accepted.

use std::path::{Path, PathBuf};

use recording::Recording;

fn manifests(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut found: Vec<_> = entries
        .flat_map(|path| {
            if path.is_dir() {
                manifests(&path)
            } else {
                vec![path]
            }
        })
        .collect();
    found.retain(|path| path.ends_with("recording.toml"));
    found
}

#[test]
fn every_real_recording_is_read() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let shared = std::env::var_os("PADDLE_SHARED").map_or(beside, PathBuf::from);
    if !shared.is_dir() {
        println!(
            "skipped: no recordings at {}; PADDLE_SHARED names another place",
            shared.display()
        );
        return;
    }
    let found = manifests(&shared.join("data"));
    assert!(!found.is_empty());
    for manifest in found {
        let recording =
            Recording::read(manifest.parent().unwrap()).unwrap_or_else(|error| panic!("{error}"));
        println!("{}: {} runs", recording.title, recording.runs.len());
        for oddity in &recording.oddities {
            println!("  {oddity}");
        }
    }
}
