//! A model that says more than the device has: a delay, a lag, a limit, a travel.

mod made;

use gap::{Options, diagnose};
use made::{paddle, recording};
use recording::Model;

const NOISE: f64 = 5e-5;

/// A paddle that a spring keeps about its middle.
fn device() -> Model {
    Model {
        stiffness: 0.05,
        ..paddle()
    }
}

/// The number `parameter` of the only effect that is found where the nominal model has what the device has not.
fn found(nominal: Model, name: &str, parameter: &str) -> f64 {
    let recording = recording(&device(), nominal, NOISE, 0.0, 11);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let [effect] = &found.effects[..] else {
        panic!("{found:?}");
    };
    assert_eq!(effect.name, name);
    assert!(found.gap.shrink > 0.95, "{:?}", found.gap);
    effect.parameters[parameter].value
}

#[test]
fn a_delay_or_lag_that_is_not_there_is_taken_away() {
    let (mut late, mut lagging) = (device(), device());
    late.delay = 0.004;
    lagging.lag = 0.006;
    let delay_s = found(late, "delay", "time");
    assert!((delay_s / -late.delay - 1.0).abs() < 0.05, "{delay_s}");
    let lag_s = found(lagging, "lag", "time");
    assert!((lag_s / -lagging.lag - 1.0).abs() < 0.05, "{lag_s}");
}

#[test]
fn a_limit_that_is_not_there_is_put_at_the_largest_input() {
    let inputs = recording(&device(), device(), NOISE, 0.0, 11);
    let inputs = inputs.runs.iter().flat_map(|run| &run.input);
    let largest = inputs.fold(0.0f64, |largest, u| largest.max(u.abs()));
    let limited = Model {
        input_limit: Some(0.0015),
        ..device()
    };
    let limit = found(limited, "saturation", "limit");
    assert!(
        (limit / largest - 1.0).abs() < 1e-3,
        "{limit} for {largest}"
    );
}

#[test]
fn stops_that_are_not_there_are_put_where_the_device_does_not_come() {
    let free = recording(&device(), device(), NOISE, 0.0, 11);
    let positions = || free.runs[0].position.iter().copied();
    let [lowest, highest] = [f64::min, f64::max].map(|of| positions().fold(0.0, of));
    let stopped = Model {
        travel: Some([0.6 * lowest, 0.7 * highest]),
        ..device()
    };
    assert!(found(stopped, "end_stop", "lower") < 0.99 * lowest);
    assert!(found(stopped, "end_stop", "upper") > 0.99 * highest);
}
