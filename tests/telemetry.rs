//! Tests of stream rows and captures, sample by sample.

use haptic_paddle::telemetry::{
    CaptureError, CapturePlan, CaptureState, Channel, Channels, Part, Sample, ShortSample,
    StreamError, StreamPlan, Telemetry, Trigger, TriggerPlan,
};

const TICK_HZ: f32 = 20_000.0;
const SAMPLES: usize = 1000;
const BAUD: u32 = 1_843_200;

fn telemetry() -> Telemetry {
    Telemetry::new(
        Box::leak(Box::new([ShortSample::NONE; SAMPLES])),
        TICK_HZ,
        BAUD,
    )
}

/// A sample in position mode whose angle contains the number of the period.
fn sample(period: u32) -> Sample {
    Sample {
        setpoint: if period >= 2000 { 0.2 } else { 0.0 },
        encoder_rad: period as f32 / 16_384.0,
        torque_nm: period as f32,
        mode: 3,
        ..Sample::default()
    }
}

fn plan(text: &str, rate_hz: f32) -> StreamPlan {
    StreamPlan::new(Channels::parse(text).unwrap(), rate_hz, TICK_HZ, BAUD).unwrap()
}

/// The samples that a complete capture sends.
fn sent(telemetry: &mut Telemetry) -> Vec<Sample> {
    let held = telemetry.capture.send().unwrap();
    let mut all = Vec::new();
    let mut chunk = [ShortSample::NONE; 8];
    assert_eq!(
        telemetry.capture.next_part(&mut chunk),
        Some(Part::Head(held))
    );
    while let Some(part) = telemetry.capture.next_part(&mut chunk) {
        let Part::Samples { first, count } = part else {
            panic!("{part:?}");
        };
        assert_eq!(first, all.len());
        all.extend(chunk[..count].iter().map(|short| Sample::from(*short)));
    }
    assert_eq!(all.len(), held.samples);
    all
}

#[test]
fn a_row_has_the_values_at_its_beginning_and_the_mean_of_the_torque_until_the_next() {
    let mut telemetry = telemetry();
    telemetry.stream.set(Some(plan("encoder,torque", 2000.0)));
    let rows: Vec<_> = (5..45)
        .filter_map(|period| telemetry.add(period, &sample(period)))
        .collect();
    let periods: Vec<_> = rows.iter().map(|row| row.period).collect();
    assert_eq!(periods, [10, 20, 30]);
    let mut room = [0; 36];
    let values: Vec<_> = link::values(rows[1].channels, rows[1].write(&mut room)).collect();
    assert_eq!(
        values,
        [(Channel::Encoder, 20.0 / 16_384.0), (Channel::Torque, 24.5)]
    );
}

#[test]
fn rows_keep_their_period_when_samples_are_missing() {
    let mut telemetry = telemetry();
    telemetry.stream.set(Some(plan("torque", 2000.0)));
    let rows: Vec<_> = (0..60)
        .filter(|period| !(25..37).contains(period))
        .filter_map(|period| telemetry.add(period, &sample(period)))
        .map(|row| row.period)
        .collect();
    assert_eq!(rows, [0, 10, 20, 30, 40]);
}

#[test]
fn a_stream_beyond_the_capacity_of_the_line_is_refused() {
    let all = Channels::ALL;
    let refused = |rate_hz, baud| StreamPlan::new(all, rate_hz, TICK_HZ, baud).unwrap_err();
    assert!(matches!(refused(5000.0, 460_800), StreamError::Line { .. }));
    assert_eq!(refused(3000.0, BAUD), StreamError::Rate);
    assert_eq!(refused(0.0, BAUD), StreamError::Rate);
    assert_eq!(refused(f32::NAN, BAUD), StreamError::Rate);
    assert_eq!(refused(-1000.0, BAUD), StreamError::Rate);
    let none = StreamPlan::new(Channels::NONE, 1000.0, TICK_HZ, BAUD);
    assert_eq!(none, Err(StreamError::NoChannel));
}

#[test]
fn a_step_is_captured_with_what_was_before_it() {
    let mut telemetry = telemetry();
    let plan = CapturePlan {
        trigger: TriggerPlan::Step,
        before: 100,
    };
    telemetry.capture.start(plan).unwrap();
    assert_eq!(telemetry.capture.send(), Err(CaptureError::NotComplete));
    for period in 0..4000 {
        telemetry.add(period, &sample(period));
    }
    let CaptureState::Holds(held) = telemetry.capture.state() else {
        panic!("{:?}", telemetry.capture.state());
    };
    assert_eq!((held.trigger, held.samples), (Trigger::Step, SAMPLES));
    assert_eq!((held.triggered_at, held.period), (100, 1900));
    let samples = sent(&mut telemetry);
    for (index, got) in samples.iter().enumerate() {
        assert_eq!(got.encoder_rad, sample(1900 + index as u32).encoder_rad);
    }
    assert!(samples[99].setpoint == 0.0 && samples[100].setpoint > 0.19);
}

#[test]
fn a_level_trigger_starts_at_the_crossing() {
    let mut telemetry = telemetry();
    let plan = CapturePlan {
        trigger: TriggerPlan::Level(Channel::Encoder, 0.05),
        before: 10,
    };
    telemetry.capture.start(plan).unwrap();
    for period in 0..2500 {
        telemetry.add(period, &sample(period));
    }
    let samples = sent(&mut telemetry);
    assert!(samples[9].encoder_rad < 0.05 && samples[10].encoder_rad >= 0.05);
}

#[test]
fn a_fault_captures_the_samples_before_it_automatically() {
    let mut telemetry = telemetry();
    for period in 0..3000 {
        let faulted = Sample {
            fault: if period >= 1500 { 8 } else { 0 },
            ..sample(period)
        };
        telemetry.add(period, &faulted);
    }
    let samples = sent(&mut telemetry);
    let first = samples.iter().position(|sample| sample.fault == 8).unwrap();
    assert_eq!(samples.len(), SAMPLES);
    assert_eq!(samples.len() - first, 200);
    assert_eq!(samples[first].encoder_rad, sample(1500).encoder_rad);
}

#[test]
fn a_fault_soon_after_the_start_keeps_the_available_samples() {
    let mut telemetry = telemetry();
    for period in 0..3000 {
        let fault = if period >= 50 { 1 } else { 0 };
        telemetry.add(
            period,
            &Sample {
                fault,
                ..sample(period)
            },
        );
    }
    assert_eq!(sent(&mut telemetry).len(), 50 + 1 + 200);
}

#[test]
fn a_pre_trigger_longer_than_the_memory_is_refused() {
    let mut telemetry = telemetry();
    let plan = CapturePlan {
        trigger: TriggerPlan::Now,
        before: SAMPLES,
    };
    assert!(matches!(
        telemetry.capture.start(plan),
        Err(CaptureError::TooLong { .. })
    ));
}
