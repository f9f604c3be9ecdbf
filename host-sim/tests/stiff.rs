//! A plant whose springs and dampers are fast relative to the step matches a much finer solution, for even and uneven steps.

use host_sim::plant::{Barrier, Follower, Friction, Link, Mechanics, Plant, Torque, TorqueProfile};
use proptest::prelude::*;

/// Product of the fastest rate and a step of the finer solution. Its error is 1e-6 of the change within a step.
const FINE_RATE_STEP: f64 = 0.1;
const ROWS: usize = 80;

/// Rows of a log. Each row is a list of pieces: a torque, N m, and its duration, s.
struct Log {
    rows: Vec<Vec<(Torque, f64)>>,
    usual_s: f64,
}

impl Log {
    /// Rows of about `usual_s` whose lengths vary by the share `uneven`. The torque is at most `largest_nm`. It comes late
    /// by the share `late` of a row and has a lag.
    fn new(usual_s: f64, uneven: f64, largest_nm: f64, late: f64, lag_s: f64) -> Self {
        let commanded = |i: usize| {
            let turn = i as f64;
            largest_nm * (0.6 * (0.21 * turn).sin() + 0.4 * (1.7 * turn).sin().signum())
        };
        let mut acting = Torque::held(0.0);
        let mut before_s = 0.0;
        let mut act = |target_nm: f64, lasts_s: f64| {
            acting = Torque::relaxing(acting.after(before_s).at(0.0), target_nm, lag_s);
            before_s = lasts_s;
            (acting, lasts_s)
        };
        let rows = (0..ROWS).map(|i| {
            let lasts_s = usual_s * (1.0 + uneven * (12.9 * (1 + i) as f64).sin());
            let late_s = late * lasts_s;
            let mut pieces = Vec::new();
            if late_s > 0.0 {
                pieces.push(act(commanded(i.saturating_sub(1)), late_s));
            }
            pieces.push(act(commanded(i), lasts_s - late_s));
            pieces
        });
        Self {
            rows: rows.collect(),
            usual_s,
        }
    }

    /// Position at the end of each row, with steps of at most `longest_s`.
    fn stepped(&self, plant: &Plant, longest_s: f64) -> Vec<f64> {
        let mut state = plant.state(0.0, 0.0, 0.0);
        let rows = self.rows.iter().map(|pieces| {
            for (torque, lasts_s) in pieces {
                let parts = (lasts_s / longest_s).ceil().max(1.0);
                let part_s = lasts_s / parts;
                for part in 0..parts as usize {
                    plant.advance(&mut state, torque.after(part as f64 * part_s), part_s);
                }
            }
            plant.seen(&state).0
        });
        rows.collect()
    }

    /// Position at the end of each row, by a follower.
    fn followed(&self, plant: &Plant) -> Vec<f64> {
        let mut profile = TorqueProfile::default();
        for pieces in &self.rows {
            pieces
                .iter()
                .for_each(|(torque, lasts_s)| profile.act(*torque, *lasts_s));
            profile.close();
        }
        let mut seen = vec![0.0; ROWS];
        let mut state = plant.state(0.0, 0.0, 0.0);
        Follower::new(plant, self.usual_s).follow(&mut state, &profile, 1.0, &mut seen);
        seen
    }

    /// Largest errors of exact steps, of quick steps and of a follower, relative to the range of the finer solution without
    /// dry friction.
    fn errors(&self, mechanics: &Mechanics, rate: f64) -> [f64; 3] {
        let [exact, quick] = [Plant::new, Plant::quick].map(|plant| plant(mechanics.clone()));
        let finer = self.stepped(&exact, FINE_RATE_STEP / rate);
        let freely = Plant::new(Mechanics {
            friction: Friction::coulomb(0.0),
            ..mechanics.clone()
        });
        let free = self.stepped(&freely, FINE_RATE_STEP / rate);
        let way = free
            .iter()
            .fold(f64::MIN_POSITIVE, |way, x| way.max(x.abs()));
        let off = |positions: Vec<f64>| {
            let pairs = positions.iter().zip(&finer);
            // NaN counts as the largest possible error.
            pairs.fold(0.0, |farthest: f64, (x, fine)| {
                let off = (x - fine).abs() / way;
                if off.is_nan() {
                    f64::INFINITY
                } else {
                    farthest.max(off)
                }
            })
        };
        [
            off(self.stepped(&exact, f64::INFINITY)),
            off(self.stepped(&quick, f64::INFINITY)),
            off(self.followed(&quick)),
        ]
    }
}

/// An inertia on a spring with dry friction, and its fastest rate, 1/s. In `step_s` it turns by `angle` rad and is damped by
/// `damped` time constants. The friction is a share of the largest torque.
fn on_a_spring(
    inertia: f64,
    [angle, damped]: [f64; 2],
    step_s: f64,
    friction_nm: f64,
) -> (Mechanics, f64) {
    let mechanics = Mechanics {
        stiffness: inertia * (angle / step_s).powi(2),
        viscous: inertia * damped / step_s,
        friction: Friction::coulomb(friction_nm),
        ..Mechanics::inertia(inertia)
    };
    (mechanics, (angle + damped) / step_s)
}

#[test]
fn a_heavily_damped_axis_with_uneven_rows_is_accurate() {
    let log = Log::new(0.033, 0.45, 0.6, 0.0, 0.0);
    let mechanics = Mechanics {
        viscous: 2.0,
        ..Mechanics::inertia(0.005)
    };
    let errors = log.errors(&mechanics, 400.0);
    assert!(errors.iter().all(|error| *error < 1e-6), "{errors:?}");
}

#[test]
fn a_servo_as_spring_and_damper_with_any_friction_is_accurate() {
    for friction_nm in [0.0, 0.001, 1.0, 20.0] {
        let log = Log::new(0.02, 0.0, 30.0, 0.0, 0.0);
        let mechanics = Mechanics {
            stiffness: 50.0,
            viscous: 20.0,
            friction: Friction::coulomb(friction_nm),
            ..Mechanics::inertia(0.0075)
        };
        let errors = log.errors(&mechanics, 2748.0);
        assert!(
            errors.iter().all(|error| *error < 1e-4),
            "{friction_nm}: {errors:?}"
        );
    }
}

/// A link between the halves of an inertia. Its natural rate and its damping rate are `rate`, 1/s.
fn stiff_link(inertia: f64, rate: f64) -> Link {
    Link {
        load_share: 0.5,
        stiffness: 0.25 * inertia * rate * rate,
        damping: 0.25 * inertia * rate,
        play: 0.0,
        load_friction: 0.5,
        sensor_on_load: false,
    }
}

#[test]
fn masses_that_oscillate_on_their_link_within_a_row_are_accurate_with_dry_friction() {
    const STEP_S: f64 = 0.02;
    let (mut mechanics, spring_rate) = on_a_spring(1e-3, [1.31, 1.0], STEP_S, 0.434);
    let link_rate = 5.47 / STEP_S;
    mechanics.link = Some(stiff_link(1e-3, link_rate));
    let log = Log::new(STEP_S, 0.05, 1.0, 0.0, 0.0);
    let errors = log.errors(&mechanics, 4.0 * (spring_rate + link_rate));
    assert!(errors.iter().all(|error| *error < 1e-2), "{errors:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn one_mass_matches_a_finer_solution(
        inertia in prop_oneof![1e-5..1e-3f64, 1e-3..1.0f64],
        step_s in prop_oneof![Just(0.001), Just(0.02), 0.001..0.05f64],
        uneven in prop_oneof![Just(0.0), 0.01..0.8f64],
        angle in prop_oneof![Just(0.0), 0.01..1.0f64, 1.0..6.0f64],
        damped in prop_oneof![Just(0.0), 0.01..1.0f64, 1.0..20.0f64, 20.0..150.0f64],
        friction in prop_oneof![Just(0.0), 1e-4..0.05f64, 0.05..1.2f64],
        late in prop_oneof![Just(0.0), 0.1..0.9f64],
        lag in prop_oneof![Just(0.0), 0.01..0.2f64, 0.2..2.0f64],
    ) {
        let (mechanics, rate) = on_a_spring(inertia, [angle, damped], step_s, friction);
        let log = Log::new(step_s, uneven, 1.0, late, lag * step_s);
        let rate = rate.max(10.0 / step_s).max(if lag > 0.0 { 1.0 / (lag * step_s) } else { 0.0 });
        let errors = log.errors(&mechanics, rate);
        prop_assert!(errors[0] < 1e-3, "{errors:?}");
        // A follower replaces a torque that changes within a row by one with the same effect at the end of the row.
        let most = if late > 0.0 || lag > 0.0 { 1e-2 } else { 3e-3 };
        prop_assert!(errors[1] < 3e-3 && errors[2] < most, "{errors:?}");
    }

    #[test]
    fn a_stiff_part_beside_other_effects_matches_a_finer_solution(
        step_s in prop_oneof![Just(0.02), 0.005..0.05f64],
        uneven in prop_oneof![Just(0.0), 0.05..0.6f64],
        angle in 0.1..3.0f64,
        damped in 1.0..60.0f64,
        friction in prop_oneof![Just(0.0), 0.01..0.5f64],
        other in 0..3usize,
        much in 0.2..1.0f64,
    ) {
        let inertia = 1e-3;
        let (mut mechanics, mut rate) = on_a_spring(inertia, [angle, damped], step_s, friction);
        match other {
            // The distance that a torque of up to 1 moves it.
            0 => mechanics.barriers[0] = Some(Barrier {
                at: 0.3 * much / (mechanics.stiffness + mechanics.viscous / step_s),
                side: 1.0,
                stiffness: 10.0 * mechanics.stiffness,
                damping: 0.1 * mechanics.viscous,
                torque_nm: 0.0,
                during_s: None,
            }),
            1 => mechanics.drag = much * mechanics.viscous / (step_s / inertia),
            _ => mechanics.link = Some(stiff_link(inertia, 10.0 * much / step_s)),
        }
        rate = 4.0 * (rate + 10.0 / step_s);
        let log = Log::new(step_s, uneven, 1.0, 0.0, 0.0);
        let errors = log.errors(&mechanics, rate);
        prop_assert!(errors.iter().all(|error| *error < 1e-2), "{errors:?}");
    }
}
