//! All real recordings in the folder beside the project are accepted.

use std::path::{Path, PathBuf};

use crate::folder::Folder;
use recording::{Recording, Run};

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

fn shared() -> Option<Vec<PathBuf>> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let shared = std::env::var_os("PADDLE_SHARED").map_or(beside, PathBuf::from);
    if !shared.is_dir() {
        println!(
            "skipped: shared_data: no recordings at {}; PADDLE_SHARED names another place",
            shared.display()
        );
        return None;
    }
    let found = manifests(&shared.join("data"));
    assert!(!found.is_empty());
    Some(
        found
            .iter()
            .filter_map(|manifest| manifest.parent())
            .map(Path::to_owned)
            .collect(),
    )
}

#[test]
fn every_real_recording_is_read() {
    for folder in shared().into_iter().flatten() {
        let recording = Recording::read(folder).unwrap_or_else(|error| panic!("{error}"));
        println!("{}: {} runs", recording.title, recording.runs.len());
        for oddity in &recording.oddities {
            println!("  {oddity}");
        }
    }
}

#[test]
fn every_real_recording_is_refused_in_degrees_and_in_milliseconds() {
    for folder in shared().into_iter().flatten() {
        let recording = Recording::read(folder).unwrap();
        let refusal = |edit: fn(&mut Run)| {
            let mut wrong = recording.clone();
            wrong.runs.iter_mut().for_each(edit);
            let copy = Folder::empty();
            wrong.write(copy.path()).unwrap();
            copy.read()
                .err()
                .unwrap_or_else(|| panic!("accepted: {}", recording.title))
                .to_string()
        };
        let degrees = refusal(|run| {
            run.position
                .iter_mut()
                .for_each(|position| *position = position.to_degrees())
        });
        assert!(degrees.contains("angles in rad"), "{degrees}");
        let milliseconds = refusal(|run| run.time.iter_mut().for_each(|time| *time *= 1e3));
        assert!(milliseconds.contains("give `time` in s"), "{milliseconds}");
    }
}
