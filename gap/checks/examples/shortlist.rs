//! How often the shortlist of the missing torque has the true effect, on blind cases or on recordings.
//!
//! ```text
//! cargo run -p gap-checks --example shortlist -- 100 7        # 100 cases of seed 7
//! cargo run -p gap-checks --example shortlist -- my-recording
//! ```

use blind::{Case, Kind, Mixture};
use gap::{Device, MissingTorque, Recording, inspected};
use rayon::prelude::*;
use std::time::Instant;

/// Sets that are looked at of each case.
const SETS: usize = 40;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.first().and_then(|word| word.parse().ok()) {
        Some(cases) => {
            let seeds = words[1..].iter().filter_map(|word| word.parse().ok());
            let seeds: Vec<u64> = seeds.collect();
            score(cases, if seeds.is_empty() { &[1] } else { &seeds });
        }
        None => words.iter().for_each(|folder| show(folder)),
    }
}

fn show(folder: &str) {
    let read = Recording::read(folder).map(inspected);
    let Ok(Ok(recording)) = read else {
        println!("{folder}: {read:?}");
        return;
    };
    let begun = Instant::now();
    let missing = MissingTorque::of(&recording, &Device::nominal(&recording.model));
    let estimated_s = begun.elapsed().as_secs_f64();
    let list = missing.shortlist(8);
    let all_s = begun.elapsed().as_secs_f64();
    println!(
        "{folder}: {:.3e} {} rms, {:.0} + {:.0} ms",
        missing.rms(),
        recording.units.input,
        1e3 * estimated_s,
        1e3 * (all_s - estimated_s),
    );
    for proposal in list {
        println!("  {:.3} {:.3?}", proposal.share, proposal.effects);
    }
}

/// What the shortlist says of a case.
struct Found {
    kind: Kind,
    truth: Vec<String>,
    /// Place of the true effect among the single effects, in the order of the sets.
    place: Option<usize>,
    /// Place of the first set that has all that is true.
    set: Option<usize>,
    first: String,
    share: f64,
}

fn score(cases: u64, seeds: &[u64]) {
    let all: Vec<(u64, u64)> = seeds
        .iter()
        .flat_map(|&seed| (1..=cases).map(move |case| (seed, case)))
        .collect();
    let found = all.into_par_iter().filter_map(|(seed, number)| {
        let case = Case::make(seed, number, &Mixture::default()).ok()?;
        if !matches!(case.truth.kind, Kind::Single | Kind::Pair) {
            return None;
        }
        let device = Device::nominal(&case.recording.model);
        let missing = MissingTorque::of(&case.recording, &device);
        let list = missing.shortlist(SETS);
        let truth: Vec<String> = case.truth.effects.iter().map(|e| e.name.clone()).collect();
        let has = |set: &gap::missing_torque::Proposal, name: &str| {
            set.effects.iter().any(|(found, _)| *found == name)
        };
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in list.iter().flat_map(|set| &set.effects) {
            if !names.contains(name) {
                names.push(name);
            }
        }
        let place = names.iter().position(|name| *name == truth[0]);
        let set = list
            .iter()
            .position(|set| truth.iter().all(|name| has(set, name)));
        let first = list.first().map(|set| format!("{:.2?}", set.effects));
        Some((
            number,
            Found {
                kind: case.truth.kind,
                truth,
                place,
                set,
                first: first.unwrap_or_default(),
                share: list.first().map_or(0.0, |set| set.share),
            },
        ))
    });
    let found: Vec<(u64, Found)> = found.collect();
    for (number, found) in &found {
        println!(
            "{number:4} {:?} {:?} place {:?} set {:?}  {:.2} {}",
            found.kind, found.truth, found.place, found.set, found.share, found.first
        );
    }
    let of = |kind: Kind| found.iter().map(|(_, f)| f).filter(move |f| f.kind == kind);
    let rate = |hits: usize, all: usize| {
        format!(
            "{hits} of {all} ({:.0} %)",
            100.0 * hits as f64 / all as f64
        )
    };
    let singles = of(Kind::Single).count();
    let within = |n: usize| {
        let hits = of(Kind::Single).filter(|f| f.place.is_some_and(|p| p < n));
        rate(hits.count(), singles)
    };
    println!("single: first {}, among four {}", within(1), within(4));
    let pairs = of(Kind::Pair).count();
    let hits = of(Kind::Pair).filter(|f| f.set.is_some_and(|s| s < 8));
    println!(
        "pairs: both in one of eight sets {}",
        rate(hits.count(), pairs)
    );
}
