//! An example diagnosis for tests.

use super::region::Labels;
use gap::diagnosis::{
    Closing, Diagnosis, Estimate, Finding, FloorOf, MeasuredBy, NextExperiment, NumberFinding,
    Profile, ProfilePart, Region, Tried, Verdict,
};
use std::collections::BTreeMap;

pub fn labels() -> Labels {
    Labels {
        position: "rad".into(),
        input: "N m".into(),
        runs: vec!["sine.csv".into(), "step.csv".into()],
        coulomb: 0.0,
        input_limit: None,
        has_stops: false,
        turned: None,
    }
}

/// Three parts of an axis, the middle one with most of the gap.
pub fn profile(along: &'static str, edges: [f64; 4]) -> Profile {
    let shares = [[0.2, 0.5], [0.71, 0.12], [0.09, 0.38]];
    let parts = edges.windows(2).zip(shares);
    let parts = parts.map(|(ends, [share_of_gap, share_of_samples])| ProfilePart {
        from: ends[0],
        to: ends[1],
        run: None,
        share_of_gap,
        share_of_samples,
    });
    Profile {
        along,
        parts: parts.collect(),
        marked: [edges[1], edges[2]],
    }
}

/// A Coulomb friction that moved within its tolerance.
pub fn moved_number() -> NumberFinding {
    NumberFinding {
        name: "coulomb".into(),
        stated: Some(0.02),
        found: 0.057,
        std: Some(0.002),
        sigmas: Some(2.1),
        shrink: 0.71,
        shrink_interval: [0.6, 0.8],
        unit: "N m".into(),
    }
}

/// A diagnosis of static friction that presliding would explain equally well.
pub fn stribeck() -> Diagnosis {
    let ratio = Estimate {
        value: 1.4,
        std: Some(0.05),
        unit: "1".into(),
        is_fitted: true,
    };
    let tried = |name, after: f64| Tried {
        name,
        after: after.to_radians(),
        why_not: "no gain on held-out data".into(),
    };
    Diagnosis {
        format: 1,
        verdict: Verdict::Explained,
        gap: Closing {
            before: 0.56f64.to_radians(),
            floor: 0.02f64.to_radians(),
            floor_of: FloorOf::CorrectedModel,
            nominal_floor: 0.03f64.to_radians(),
            after: 0.12f64.to_radians(),
            standing: 1.9f64.to_radians(),
            coasting: 0.8f64.to_radians(),
            shrink: 0.81,
            shrink_interval: [0.76, 0.85],
            unit: "rad".into(),
        },
        effects: vec![Finding {
            name: "stribeck",
            channel: "friction",
            confidence: 0.97,
            not_separable_from: vec!["presliding"],
            basis: "prediction",
            held_out: true,
            parameters: [("static_ratio".to_owned(), ratio)].into(),
            shrink: 0.81,
            shrink_interval: [0.76, 0.85],
        }],
        numbers: Vec::new(),
        rejection: None,
        regions: vec![Region {
            axis: "velocity",
            from: Some(-0.05),
            to: Some(0.05),
            name: None,
            run: None,
            measured_by: MeasuredBy::ShortPredictions,
            share_of_gap: 0.71,
            share_of_gap_interval: [0.62, 0.79],
            share_of_samples: 0.12,
            profile: Some(profile("velocity", [-0.3, -0.05, 0.05, 0.3])),
        }],
        candidates: vec![
            tried("viscous", 0.47),
            tried("delay", 0.5),
            tried("lag", 0.5),
        ],
        next_experiment: Some(NextExperiment {
            kind: "ramp",
            separates: vec!["stribeck", "presliding"],
            settings: BTreeMap::from([("amplitude", 0.02), ("duration_s", 10.0)]),
            difference_over_noise: 12.0,
        }),
        warnings: vec!["sine.csv: 3 gaps in time".into()],
        elapsed_s: 1.9,
    }
}
