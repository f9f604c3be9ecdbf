//! A different gravity torque: another weight, or another position at which it hangs.

use super::identification::{Family, Identification, MainNumber, SmallMotion};
use super::phrase::Found;
use super::restoring::{equivalent_start, small_motion};
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::balance::Balance;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::gravity::KIND;
use recording::{Model, Recording};

/// Index of the parameter `zero`.
const ZERO: usize = 1;

#[derive(Debug)]
pub(super) struct Gravity;

impl Identification for Gravity {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let m = &e.device.mechanics;
        let angle_rad = m.angle_rad;
        let guess = regress(e, |m| {
            let (sin, cos) = (angle_rad * m.position).sin_cos();
            [-sin, cos]
        });
        let guess = guess.map(|[a, b]| {
            let (sin, cos) = (angle_rad * m.gravity_zero).sin_cos();
            let (a, b) = (a + m.gravity * cos, b + m.gravity * sin);
            let weight = guessed(0, a.hypot(b), 0.1 * s.torque);
            vec![
                weight,
                linear(ZERO, b.atan2(a) / angle_rad, 0.1 / angle_rad),
            ]
        });
        let hanging = vec![
            linear(0, m.gravity, 0.1 * s.torque),
            linear(ZERO, m.gravity_zero, 0.1 * s.span().min(1.0 / angle_rad)),
        ];
        terms(&KIND, guess, [hanging])
    }

    fn stated_parameter(&self, model: &Model) -> Option<(usize, f64)> {
        Some((ZERO, model.gravity_zero))
    }

    fn is_impossible(&self, recording: &Recording) -> bool {
        // A linear axis without a weight in its model is no pendulum.
        recording.units.is_length() && recording.model.gravity == 0.0
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset]
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Restoring)
    }

    fn on_small_motion(&self, fitted: &Term, model: &Model) -> Option<SmallMotion> {
        Some(small_motion(fitted, stated(model)))
    }

    fn equivalent_start(&self, own: &Term, other: SmallMotion, model: &Model) -> Option<Term> {
        equivalent_start(own, other, stated(model))
    }

    fn main_number(&self) -> Option<MainNumber> {
        Some(MainNumber {
            name: "gravity",
            usual_error: Some(0.05),
        })
    }

    fn balanced(&self, own: &Term, balance: &Balance) -> Term {
        own.starting_at(&[(0, balance.weight), (ZERO, balance.zero)])
    }

    fn axis(&self) -> Axis {
        Axis::Position
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let m = &path.device.mechanics;
        let angle = m.angle_rad;
        if angle == 0.0 {
            return Vec::new();
        }
        let step = path.scale.torque_step();
        let mut forms = Vec::new();
        if m.gravity != 0.0 {
            let base = [m.gravity, m.gravity_zero];
            forms.push(Form::linear(path, &KIND, &base, &[(0, step)]));
        }
        let of = |f: fn(f64) -> f64| -> Vec<f64> {
            path.position.iter().map(|x| step * f(angle * x)).collect()
        };
        let columns = vec![of(|a| -a.sin()), of(f64::cos)];
        let (weight, zero) = (m.gravity, angle * m.gravity_zero);
        forms.push(Form::new(columns, move |c| {
            let across = weight * zero.cos() + c[0] * step;
            let along = weight * zero.sin() + c[1] * step;
            vec![across.hypot(along), along.atan2(across) / angle]
        }));
        forms
    }

    fn noun(&self) -> &'static str {
        "another weight"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a sine over the position with a period of one turn. A spring is a line: over less than a quarter of a turn the two cannot be told apart. Record motion over the whole travel."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a weight of {weight} that hangs at {zero}"
    }
}

fn stated(model: &Model) -> [f64; 2] {
    [model.gravity, model.gravity_zero]
}
