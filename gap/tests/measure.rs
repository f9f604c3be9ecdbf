//! A perfect model's gap is the floor; a wrong one's is above it.

mod made;

use host_sim::device::Device;
use host_sim::effects::Effect;
use host_sim::plant::Link;
use made::{paddle, recorded, recording};
use recording::Model;

#[test]
fn a_perfect_model_is_at_the_floor() {
    for (noise, resolution) in [(1e-4, 0.0), (1e-3, 0.0), (1e-4, 2.09e-4), (0.0, 2.09e-4)] {
        // The velocity error of a few restarts decides a gap, so that single ones scatter.
        let ratios = (0..16).map(|seed| {
            let recording = recording(&paddle(), paddle(), noise, resolution, seed);
            let (gap, _) = gap::measure(&recording, &Device::nominal(&paddle()));
            (gap.before / gap.floor).powi(2)
        });
        let ratio = (ratios.sum::<f64>() / 16.0).sqrt();
        assert!(
            (1.0..1.3).contains(&ratio),
            "noise {noise}, quantum {resolution}: {ratio}"
        );
    }
}

/// Excess of a right model over the floor, over the gap of one that knows nothing of what the sensor hides, by seed.
fn excesses(effect: &str, seeds: u64) -> impl Iterator<Item = f64> {
    let mut device = Device::nominal(&paddle());
    effect.parse::<Effect>().unwrap().install(&mut device);
    (0..seeds).map(move |seed| {
        let recording = recorded(&device, paddle(), 1e-4, 0.0, seed);
        let (blind, _) = gap::measure(&recording, &Device::nominal(&paddle()));
        let (gap, _) = gap::measure(&recording, &device);
        (gap.before.powi(2) - gap.floor.powi(2)).max(0.0).sqrt() / blind.before
    })
}

#[test]
fn how_far_a_sensor_lags_is_carried_over_the_restarts() {
    for excess in excesses("sensor_lag:time=0.03", 4) {
        assert!(excess < 0.05, "{excess}");
    }
}

#[test]
fn where_a_play_stands_is_carried_over_the_restarts() {
    // As above, single restarts scatter.
    let squares = excesses("sensor_hysteresis:width=0.03", 8).map(|excess| excess.powi(2));
    let excess = (squares.sum::<f64>() / 8.0).sqrt();
    assert!(excess < 0.05, "{excess}");
}

#[test]
fn friction_drifts_from_the_first_sample_of_the_session_on() {
    const LATER_S: f64 = 64.0;
    let mut device = Device::nominal(&paddle());
    let drift = "friction_drift:rate=0.4,settling=3";
    drift.parse::<Effect>().unwrap().install(&mut device);
    let mut recording = recorded(&device, paddle(), 1e-4, 0.0, 3);
    let (blind, _) = gap::measure(&recording, &Device::nominal(&paddle()));
    for time in recording.runs.iter_mut().flat_map(|run| &mut run.time) {
        *time += LATER_S;
    }
    let (gap, _) = gap::measure(&recording, &device);
    assert!(gap.before < 0.1 * blind.before, "{gap:?}, {blind:?}");
}

#[test]
fn friction_drifts_on_from_run_to_run_or_anew_in_each() {
    let drifting = |written: &str| {
        let mut device = Device::nominal(&paddle());
        written.parse::<Effect>().unwrap().install(&mut device);
        device
    };
    let anew = drifting("friction_drift:rate=0.4,settling=3,anew=1");
    let mut recording = recorded(&anew, paddle(), 1e-4, 0.0, 3);
    // The clock starts anew, too.
    recording.runs.push(recording.runs[0].clone());
    let (closed, _) = gap::measure(&recording, &anew);
    let on = drifting("friction_drift:rate=0.4,settling=3");
    let (open, _) = gap::measure(&recording, &on);
    assert!(closed.before < 0.1 * open.before, "{closed:?}, {open:?}");
}

#[test]
fn a_wrong_model_is_above_it_and_the_predictions_say_where() {
    let nominal = Model {
        coulomb: 0.012,
        ..paddle()
    };
    let recording = recording(&paddle(), nominal, 1e-4, 0.0, 7);
    let (gap, runs) = gap::measure(&recording, &Device::nominal(&nominal));
    assert!(gap.before > 10.0 * gap.floor, "{gap:?}");
    let squares = runs[0]
        .measured
        .iter()
        .zip(&runs[0].predicted)
        .map(|(m, p)| (m - p).powi(2));
    let rms = (squares.sum::<f64>() / runs[0].time.len() as f64).sqrt();
    assert!((rms - gap.before).abs() < 1e-12);
}

#[test]
fn a_model_that_moves_where_the_device_sticks_throughout_has_not_run_away() {
    const HOLDING_NM: f64 = 0.06;
    let stuck = Model {
        coulomb: HOLDING_NM,
        ..paddle()
    };
    let recording = recording(&stuck, paddle(), 0.0, 2.09e-4, 1);
    let (gap, _) = gap::measure(&recording, &Device::nominal(&paddle()));
    assert!(gap.before > 10.0 * gap.floor, "{gap:?}");
    let (gap, _) = gap::measure(&recording, &Device::nominal(&stuck));
    assert_eq!(gap.before, 0.0);
}

#[test]
fn a_thinned_recording_is_predicted_as_the_whole_one() {
    let recording = recording(&paddle(), paddle(), 1e-4, 0.0, 7);
    let whole = gap::series::coarse(&recording, 0.05);
    let some = gap::series::some_coarse(&recording, 0.05, 3000);
    let samples: usize = some.iter().map(|s| s.time.len()).sum();
    assert!((1500..4500).contains(&samples), "{samples}");
    let predictor = gap::predict::Predictor::new(Device::nominal(&paddle()), &recording);
    let all = predictor.predict(&whole[0]);
    for block in &some {
        let at = whole[0].time.partition_point(|t| *t < block.time[0]);
        let predicted = predictor.predict(block);
        // The input just before a block is taken to be that of its first sample.
        for (i, p) in predicted.iter().enumerate() {
            assert!((p - all[at + i]).abs() < 1e-4, "{i}: {p} {}", all[at + i]);
        }
    }
}

#[test]
fn what_rings_has_settled_in_a_window_that_stands_alone() {
    let mut device = Device::nominal(&paddle());
    // Rings at some 5 Hz for several windows of 0.3 s.
    device.mechanics.link = Some(Link {
        load_share: 0.5,
        stiffness: 0.14,
        damping: 5e-4,
        play: 0.0,
        load_friction: 0.5,
        sensor_on_load: true,
    });
    let recording = recorded(&device, paddle(), 0.0, 2e-5, 7);
    let predictor = gap::predict::Predictor::new(device, &recording);
    for series in gap::series::coarse(&recording, recording.horizon) {
        let all = predictor.predict(&series);
        let alone = predictor.predict_shifted(&series, [0.0, 0.0], |w| w % 20 >= 10);
        let rms = |of: &dyn Fn(usize) -> f64| -> f64 {
            let windows = series.windows.iter().enumerate();
            let rows = windows.filter(|(w, _)| w % 20 >= 10);
            let squares = rows
                .flat_map(|(_, w)| w.samples.clone())
                .map(|i| of(i).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let apart = rms(&|i| alone[i] - all[i]);
        let moved = rms(&|i| series.position[i]);
        assert!(apart < 1e-3 * moved, "{apart} apart of {moved}");
    }
}
