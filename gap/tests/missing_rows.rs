//! What was told where rows are missing nobody knows: prediction begins anew after them.

mod made;

use gap::{Device, Options, Recording, diagnose, measure};
use made::{paddle, recording};
use recording::Model;

const NOISE: f64 = 5e-5;
/// First row that is missing, and how many are: 0.6 s.
const MISSING: [usize; 2] = [5000, 1200];

/// A device that drags more than its model says, with or without all rows.
fn dragging(is_whole: bool) -> Recording {
    let device = Model {
        viscous: 8e-4,
        ..paddle()
    };
    let mut recording = recording(&device, paddle(), NOISE, 0.0, 11);
    let [from, count] = MISSING;
    let run = &mut recording.runs[0];
    for column in [&mut run.time, &mut run.input, &mut run.position] {
        if !is_whole {
            column.drain(from..from + count);
        }
    }
    recording
}

#[test]
fn missing_rows_neither_make_a_gap_nor_hide_one() {
    let [whole, broken] = [true, false].map(|is_whole| {
        let recording = dragging(is_whole);
        let (gap, runs) = measure(&recording, &Device::nominal(&recording.model));
        let [run] = &runs[..] else {
            panic!("{} runs of one", runs.len());
        };
        assert_eq!(run.time, recording.runs[0].time);
        gap
    });
    assert!((broken.before / whole.before - 1.0).abs() < 0.1);
    assert!((broken.floor / whole.floor - 1.0).abs() < 0.3);
}

#[test]
fn what_causes_a_gap_is_found_beside_missing_rows() {
    let recording = dragging(false);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let [effect] = &found.effects[..] else {
        panic!("{found:?}");
    };
    assert_eq!(effect.name, "viscous");
    assert!(found.gap.shrink > 0.95, "{:?}", found.gap);
    let runs = found.regions.iter().filter_map(|region| region.run);
    assert!(runs.max().unwrap_or(0) < recording.runs.len());
}
