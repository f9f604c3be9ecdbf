//! Tests that oddities are reported, and that ordinary data are not.

use crate::folder::Folder;
use recording::{Drive, Model, Oddity, Recording, Run, Sensor};

const RESOLUTION: f64 = 2e-3;

/// A quantised sine of two seconds at 1 kHz.
fn run(file: &str) -> Run {
    let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
    let input = time.iter().map(|t| 0.1 * (6.0 * t).cos()).collect();
    let position = time
        .iter()
        .map(|t| (0.3 * (6.0 * t).sin() / RESOLUTION).round() * RESOLUTION)
        .collect();
    Run::new(file, Drive::OpenLoop, time, input, position)
}

fn recording(runs: Vec<Run>) -> Recording {
    let mut recording = Recording::new(
        "test",
        0.25,
        Model {
            coulomb: 0.01,
            ..Model::new(5e-3)
        },
    );
    recording.sensors.insert(
        "position".into(),
        Sensor {
            resolution: RESOLUTION,
            ..Sensor::default()
        },
    );
    recording.runs = runs;
    recording
}

fn reread(recording: &Recording) -> Recording {
    let folder = Folder::empty();
    recording.write(folder.path()).unwrap();
    folder.read().unwrap()
}

fn oddities_of(recording: &Recording) -> Vec<Oddity> {
    reread(recording).oddities
}

/// The only oddity of a run changed by `edit`, and the number of its rows that are left out.
#[track_caller]
fn oddity_and_left_out(edit: impl Fn(&mut Run)) -> (Oddity, usize) {
    let mut run = run("a.csv");
    edit(&mut run);
    let rows = run.len();
    let mut read = reread(&recording(vec![run]));
    let found = &mut read.oddities;
    assert_eq!(found.len(), 1, "{found:?}");
    (found.remove(0), rows - read.runs[0].len())
}

#[track_caller]
fn oddity(edit: impl Fn(&mut Run)) -> Oddity {
    oddity_and_left_out(edit).0
}

/// Limits the sensor to 0.2.
fn limit(run: &mut Run) {
    let limited = |position: &mut f64| *position = position.min(0.2);
    run.position.iter_mut().for_each(limited);
}

#[test]
fn an_ordinary_recording_has_none() {
    assert_eq!(
        oddities_of(&recording(vec![run("a.csv"), run("b.csv")])),
        []
    );
}

#[test]
fn jitter() {
    let found = oddity(|run| {
        run.time
            .iter_mut()
            .step_by(2)
            .for_each(|time| *time += 2e-4)
    });
    let Oddity::Jitter { p05_s, p95_s, .. } = found else {
        panic!("{found}")
    };
    assert!(
        (p05_s - 8e-4).abs() < 1e-9 && (p95_s - 1.2e-3).abs() < 1e-9,
        "{p05_s} {p95_s}"
    );
}

#[test]
fn equal_oddities_of_several_runs_share_a_line() {
    let file = |k: usize| format!("{k}.csv");
    let constant = |k| {
        let mut run = run(&file(k));
        run.input.fill(0.0);
        run
    };
    let lines = |count| reread(&recording((0..count).map(constant).collect())).warnings();
    let constant = |line: &String| line.contains("`input` is 0");
    let of = |count| {
        lines(count)
            .into_iter()
            .filter(constant)
            .collect::<Vec<_>>()
    };
    assert!(matches!(&of(1)[..], [one] if !one.contains("likewise")));
    assert!(matches!(&of(3)[..], [one] if one.ends_with("; likewise 1.csv, 2.csv")));
    assert!(matches!(&of(9)[..], [one] if one.ends_with("; likewise 8 other runs")));
}

#[test]
fn gaps() {
    let found = oddity(|run| run.time[700..].iter_mut().for_each(|time| *time += 0.02));
    let Oddity::Gaps {
        count,
        longest_s,
        at_s,
        ..
    } = found
    else {
        panic!("{found}")
    };
    assert_eq!(count, 1);
    assert!(
        (longest_s - 0.021).abs() < 1e-9 && (at_s - 0.699).abs() < 1e-9,
        "{longest_s} {at_s}"
    );
}

#[test]
fn constant_input() {
    assert_eq!(
        oddity(|run| run.input.fill(0.0)),
        Oddity::ConstantInput {
            file: "a.csv".into(),
            value: 0.0
        }
    );
}

#[test]
fn frozen_columns() {
    let frozen = |column: &str| Oddity::FrozenColumn {
        file: "a.csv".into(),
        column: column.into(),
    };
    assert_eq!(
        oddity(|run| run.current = Some(vec![0.5; run.len()])),
        frozen("current")
    );

    let folder = Folder::empty();
    recording(vec![run("a.csv")]).write(folder.path()).unwrap();
    let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let mut rows = text.lines();
    let mut wider = format!("{},still,note\n", rows.next().unwrap());
    for (k, row) in rows.enumerate() {
        wider += &format!("{row},7,\"n {k}\"\n");
    }
    let read = folder.with("a.csv", wider).read().unwrap();
    assert_eq!(read.oddities, [frozen("still")]);
    assert_eq!(read.runs[0].ignored, ["still", "note"]);
}

#[test]
fn the_rows_in_which_a_sensor_saturates_are_left_out() {
    let (found, left_out) = oddity_and_left_out(limit);
    let Oddity::Saturated { value, stay_s, .. } = found else {
        panic!("{found}")
    };
    // 0.3 sin(6 t) stays above 0.2 from t = 0.122 to 0.402 s.
    assert!(
        (value - 0.2).abs() < 1e-9 && (stay_s - 0.28).abs() < 0.01,
        "{value} {stay_s}"
    );
    let whole = run("a.csv").position.into_iter();
    assert_eq!(left_out, whole.filter(|x| *x >= 0.2).count());
}

#[test]
fn a_sensor_limit_found_in_one_run_applies_to_other_runs() {
    let mut runs = [run("a.csv"), run("b.csv")];
    runs.iter_mut().for_each(limit);
    // The first row of the other run is within 0.122 to 0.402 s, and its last one within 1.169 to 1.449 s.
    let [_, ends_there] = &mut runs;
    for column in [
        &mut ends_there.time,
        &mut ends_there.input,
        &mut ends_there.position,
    ] {
        column.truncate(1400);
        column.drain(..200);
    }
    let read = reread(&recording(runs.to_vec()));
    let saturated = read.oddities.iter().filter_map(|oddity| match oddity {
        Oddity::Saturated { file, .. } => Some(file.as_str()),
        _ => None,
    });
    assert_eq!(saturated.collect::<Vec<_>>(), ["a.csv", "b.csv"]);
    assert!(read.runs[1].len().abs_diff(1169 - 402) < 5);
}

#[test]
fn rows_at_a_mechanical_stop_are_kept() {
    let (found, left_out) = oddity_and_left_out(|run| {
        for (k, position) in run.position.iter_mut().enumerate() {
            // The device reaches the stop at 0.3 s, stays until 0.6 s, and then moves back.
            let time_s = k as f64 * 1e-3;
            let since_s = [0.3 - time_s, time_s - 0.6].map(|s| s.max(0.0));
            let at = 0.5 - 2.0 * since_s[0] - 2.0 * since_s[1].powi(2);
            *position = (at / RESOLUTION).round() * RESOLUTION;
        }
    });
    let Oddity::Held { value, .. } = found else {
        panic!("{found}")
    };
    assert_eq!((value, left_out), (0.5, 0));
}

#[test]
fn rows_with_a_frozen_position_are_left_out() {
    let (found, left_out) = oddity_and_left_out(|run| {
        for row in [700..820, 1600..1650].into_iter().flatten() {
            run.position[row] = run.position[row - 1];
        }
    });
    let Oddity::FrozenPosition {
        count,
        from_s,
        stay_s,
        ..
    } = found
    else {
        panic!("{found}")
    };
    assert_eq!(count, 2);
    assert!((from_s - 0.699).abs() < 2e-3 && (stay_s - 0.121).abs() < 2e-3);
    assert!(left_out.abs_diff(170) < 5);
}

#[test]
fn rows_that_repeat_the_position_are_left_out() {
    const EVERY: usize = 4;
    let mut run = run("a.csv");
    let rows = run.len();
    let told: f64 = run.input.iter().sum();
    for row in 0..rows {
        run.position[row] = run.position[row - row % EVERY];
    }
    let read = reread(&recording(vec![run]));
    let [Oddity::Repeated { every, .. }] = read.oddities[..] else {
        panic!("{:?}", read.oddities)
    };
    assert_eq!(every, EVERY);
    let run = &read.runs[0];
    assert!(run.len().abs_diff(rows / EVERY) < 5, "{}", run.len());
    let means = run.input.iter().sum::<f64>() * EVERY as f64;
    assert!((means - told).abs() < 1e-5 * rows as f64, "{means} {told}");
}

#[test]
fn a_slow_motion_of_a_counter_is_not_taken_as_repeated_rows() {
    let mut run = run("a.csv");
    for (k, position) in run.position.iter_mut().enumerate() {
        *position = (k / 7) as f64 * RESOLUTION;
    }
    assert_eq!(oddities_of(&recording(vec![run])), []);
}

#[test]
fn the_rows_of_spikes_are_left_out() {
    let (found, left_out) = oddity_and_left_out(|run| {
        for at in [300, 900, 1700] {
            run.position[at] += 0.05;
        }
        run.position[1200] -= 0.08;
    });
    let Oddity::Spikes {
        count,
        farthest,
        at_s,
        ..
    } = found
    else {
        panic!("{found}")
    };
    assert_eq!((count, at_s), (4, 1.2));
    assert!((farthest - 0.08).abs() < RESOLUTION, "{farthest}");
    assert_eq!(left_out, 4);
}

#[test]
fn a_jump_an_impact_and_a_flickering_count_are_not_spikes() {
    let mut run = run("a.csv");
    for (k, position) in run.position.iter_mut().enumerate() {
        // A jump of a counter, an impact at a stop, and a counter that flickers between two counts at rest.
        *position = match k {
            0..1000 => 0.01 * k as f64 - if k >= 500 { 3.0 } else { 0.0 },
            1000..1500 => 7.0 - 0.01 * (k - 1000) as f64,
            _ => 2.0 + if k % 50 == 0 { RESOLUTION } else { 0.0 },
        };
    }
    let found = oddities_of(&recording(vec![run]));
    let is_spikes = |oddity: &Oddity| matches!(oddity, Oddity::Spikes { .. });
    assert!(!found.iter().any(is_spikes), "{found:?}");
}

#[test]
fn a_first_sample_far_from_the_next_ones_is_left_out() {
    let mut run = run("a.csv");
    let rows = run.len();
    run.position[0] += 0.2;
    let read = reread(&recording(vec![run]));
    let [Oddity::StaleStart { off, .. }] = read.oddities[..] else {
        panic!("{:?}", read.oddities)
    };
    assert!((off - 0.2).abs() < 2.0 * RESOLUTION, "{off}");
    assert_eq!(read.runs[0].len(), rows - 1);
}

#[test]
fn a_start_at_rest_or_in_motion_is_accepted() {
    for start in [0, 137] {
        let mut run = run("a.csv");
        for (k, position) in run.position.iter_mut().enumerate() {
            let t = 1e-3 * (k + start) as f64;
            *position = ((0.5 - 0.5 * (20.0 * t).cos()) / RESOLUTION).round() * RESOLUTION;
        }
        assert_eq!(oddities_of(&recording(vec![run])), []);
    }
}

#[test]
fn sticking_until_breakaway_is_not_saturation() {
    let mut ramp = run("a.csv");
    for (k, (input, position)) in ramp.input.iter_mut().zip(&mut ramp.position).enumerate() {
        let t = k as f64 * 1e-3;
        *input = 0.01 * t;
        *position = ((0.2 * (t - 1.0).max(0.0).powi(2)) / RESOLUTION).round() * RESOLUTION;
    }
    assert_eq!(oddities_of(&recording(vec![ramp])), []);
}

#[test]
fn a_resolution_other_than_stated() {
    for (stated, odd) in [
        (RESOLUTION, false),
        (RESOLUTION / 4.0, true),
        (RESOLUTION * 4.0, true),
        (0.0, true),
    ] {
        let mut recording = recording(vec![run("a.csv")]);
        recording.sensors.insert(
            "position".into(),
            Sensor {
                resolution: stated,
                ..Sensor::default()
            },
        );
        let found = oddities_of(&recording);
        assert_eq!(found.len(), usize::from(odd), "{stated}: {found:?}");
        for oddity in found {
            let Oddity::Resolution { seen, .. } = oddity else {
                panic!("{oddity}")
            };
            assert!((seen - RESOLUTION).abs() < 1e-9, "{seen}");
        }
    }
}

#[test]
fn noise_far_above_the_stated_one() {
    const STATED: f64 = 1e-4;
    // Pseudo-random numbers over their standard deviation.
    let stray = |k: f64| ((k * k * 0.618_033_988_749_895) % 1.0 - 0.5) * 12f64.sqrt();
    let jittering = |std: f64| {
        let mut run = run("a.csv");
        for (k, (t, position)) in run.time.iter().zip(&mut run.position).enumerate() {
            *position = 0.3 * (6.0 * t).sin() + std * stray(k as f64);
        }
        let mut recording = recording(vec![run]);
        let sensor = Sensor {
            noise: STATED,
            ..Sensor::default()
        };
        recording.sensors.insert("position".into(), sensor);
        oddities_of(&recording)
    };
    assert_eq!(jittering(3.0 * STATED), []);
    let found = jittering(10.0 * STATED);
    let [Oddity::Noisy { seen, stated, .. }] = found[..] else {
        panic!("{found:?}")
    };
    assert!((seen / (10.0 * STATED) - 1.0).abs() < 0.2, "{seen}");
    assert!((stated - STATED).abs() < 1e-12, "{stated}");
}

#[test]
fn a_coarsely_quantised_supply() {
    let found = oddity(|run| {
        run.supply = Some(
            run.input
                .iter()
                .map(|input| if *input > 0.0 { 7.4 } else { 7.5 })
                .collect(),
        );
    });
    let Oddity::CoarseSupply { step, .. } = found else {
        panic!("{found}")
    };
    assert!((step - 0.1).abs() < 1e-6, "{step}");
}

#[test]
fn runs_that_overlap_in_session_time() {
    let shifted = |file: &str, by: f64| {
        let mut run = run(file);
        run.time.iter_mut().for_each(|time| *time += by);
        run
    };
    let apart = recording(vec![shifted("b.csv", 5.0), shifted("a.csv", 0.0)]);
    assert_eq!(oddities_of(&apart), []);
    let overlapping = recording(vec![shifted("b.csv", 1.5), shifted("a.csv", 0.0)]);
    assert_eq!(
        oddities_of(&overlapping),
        [Oddity::Overlap {
            first: "a.csv".into(),
            second: "b.csv".into()
        }]
    );
}

#[test]
fn a_column_without_a_sensor_and_an_unknown_key() {
    let mut hall = recording(vec![run("a.csv")]);
    let position = hall.runs[0].position.clone();
    hall.runs[0]
        .positions
        .insert("position_hall".into(), position);
    assert_eq!(
        oddities_of(&hall),
        [Oddity::SensorAssumed {
            column: "position_hall".into()
        }]
    );

    let folder = Folder::empty();
    recording(vec![run("a.csv")]).write(folder.path()).unwrap();
    let text = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
    let read = folder
        .with(
            "recording.toml",
            format!("restart_half_widht = 0.01\n{text}"),
        )
        .read()
        .unwrap();
    let [oddity] = read.oddities.as_slice() else {
        panic!("{:?}", read.oddities)
    };
    let said = oddity.to_string();
    assert!(
        said.contains("line 1") && said.contains("was `restart_half_width` meant?"),
        "{said}"
    );
}
