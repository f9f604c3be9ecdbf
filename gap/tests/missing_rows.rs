//! What was told where rows are missing nobody knows: prediction begins anew after them.

mod made;

use gap::{Device, Options, Recording, diagnose, measure};
use made::{paddle, recording};
use recording::Model;

const NOISE: f64 = 5e-5;

/// Rows that are missing for 0.6 s.
fn a_hole() -> impl Fn(usize) -> bool {
    |row| (5000..6200).contains(&row)
}

/// Rows that are missing for 0.05 s, again and again: one in sixty of those that are left is followed by such a hole.
fn many_holes() -> impl Fn(usize) -> bool {
    |row| row % 160 < 100
}

/// A device that drags more than its model says, without the rows that are missing.
fn dragging(is_missing: impl Fn(usize) -> bool) -> Recording {
    let device = Model {
        viscous: 8e-4,
        ..paddle()
    };
    without(is_missing, recording(&device, paddle(), NOISE, 0.0, 11))
}

/// A recording without some rows of its first run.
fn without(is_missing: impl Fn(usize) -> bool, mut recording: Recording) -> Recording {
    let run = &mut recording.runs[0];
    for column in [&mut run.time, &mut run.input, &mut run.position] {
        let mut rows = 0..;
        column.retain(|_| rows.next().is_some_and(|row| !is_missing(row)));
    }
    recording
}

#[test]
fn missing_rows_neither_make_a_gap_nor_hide_one() {
    let [whole, broken] = [dragging(|_| false), dragging(a_hole())].map(|recording| {
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
    for recording in [dragging(a_hole()), dragging(many_holes())] {
        let found = diagnose(&recording, &Options::default()).diagnosis;
        let [effect] = &found.effects[..] else {
            panic!("{found:?}");
        };
        assert_eq!(effect.name, "viscous");
        assert!(found.gap.shrink > 0.95, "{:?}", found.gap);
        let runs = found.regions.iter().filter_map(|region| region.run);
        assert!(runs.max().unwrap_or(0) < recording.runs.len());
    }
}

#[test]
fn what_is_late_comes_after_missing_rows_too() {
    let late = Model {
        delay: 4e-3,
        lag: 1e-2,
        ..paddle()
    };
    let recording = recording(&late, late, NOISE, 0.0, 11);
    let left = |recording: &Recording| {
        let (gap, _) = measure(recording, &Device::nominal(&recording.model));
        gap.before / gap.floor
    };
    let whole = left(&recording);
    let broken = left(&without(a_hole(), recording));
    assert!(broken < 1.3 * whole, "{broken} {whole}");
}
