//! A drive may be told far more than it gives.

mod made;

use gap::{Options, diagnose};
use made::{paddle, recording};
use recording::Model;

#[test]
fn a_lower_limit_is_found_where_most_inputs_are_beyond_the_nominal_one() {
    let limited = |limit| Model {
        input_limit: Some(limit),
        ..paddle()
    };
    let recording = recording(&limited(4e-4), limited(6e-4), 1e-4, 0.0, 5);
    let found = diagnose(&recording, &Options::default()).diagnosis;
    let names: Vec<&str> = found.effects.iter().map(|e| e.name).collect();
    assert_eq!(names, ["saturation"]);
    let limit = &found.effects[0].parameters["limit"];
    assert!((limit.value - 4e-4).abs() < 1e-5, "{limit:?}");
}
