//! A spring towards a position, which may be progressive.

use super::identification::{Family, Identification, SmallMotion};
use super::phrase::Found;
use super::restoring::{equivalent_start, small_motion};
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, log, term, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use host_sim::effects::Kind;
use host_sim::effects::spring::KIND;
use recording::Model;

/// Index of the parameter `hardening`, and the relative increase of the stiffness at the ends of the motion at the start.
const HARDENING: usize = 2;
const HARDENED: f64 = 0.3;
/// Relative increase for a start with a strongly progressive spring.
const STRONGLY_HARDENED: f64 = 3.0;

#[derive(Debug)]
pub(super) struct Spring;

impl Identification for Spring {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let m = &e.device.mechanics;
        let stiffness = s.torque / s.span();
        let guess = regress(e, |m| [-m.position, 1.0]).map(|[k, t]| {
            let pull = m.stiffness + k;
            let zero = (t + m.stiffness * m.stiffness_zero) / pull;
            let pull = guessed(0, pull, 0.05 * stiffness);
            vec![pull, linear(1, zero, 0.2 * s.span())]
        });
        let zero = if m.stiffness == 0.0 {
            s.middle()
        } else {
            m.stiffness_zero
        };
        let weak = vec![
            linear(0, m.stiffness + 0.05 * stiffness, 0.1 * stiffness),
            linear(1, zero, 0.2 * s.span()),
        ];
        let mut starts = terms(&KIND, guess, [weak]);
        if m.stiffness == 0.0 {
            starts.extend(hardening(e, stiffness));
        }
        starts
    }

    fn further_shape(&self, fitted: &Term, half_span: f64) -> Vec<Coordinate> {
        let hardening = || log(HARDENING, HARDENED / (half_span * half_span));
        let hardening = (!fitted.is_free(HARDENING)).then(hardening);
        hardening.into_iter().collect()
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

    fn replaces(&self) -> Option<&'static str> {
        Some("stiffness")
    }

    fn axis(&self) -> Axis {
        Axis::Position
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let m = &path.device.mechanics;
        let (half, middle) = (path.scale.half_span(), path.scale.middle());
        let step = path.scale.torque_step();
        let away = |power: i32| -> Vec<f64> {
            let positions = path.position.iter();
            positions
                .map(|x| -step * ((x - middle) / half).powi(power))
                .collect()
        };
        let constant = vec![step; path.position.len()];
        let (stiffness, zero) = (m.stiffness, m.stiffness_zero);
        let values = move |c: &[f64]| {
            let pull = stiffness + c[0] * step / half;
            let offset = stiffness * (zero - middle) + c[1] * step;
            let hardening = c.get(2).map_or(0.0, |c| c * step / half.powi(3) / pull);
            vec![pull, middle + offset / pull, hardening]
        };
        vec![
            Form::new(vec![away(1), constant.clone()], values),
            Form::new(vec![away(1), constant, away(3)], values),
        ]
    }

    fn noun(&self) -> &'static str {
        "a spring"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a line over the position, through zero where the spring is relaxed. A weight is a sine. Record motion over the whole travel."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a spring of {stiffness} that is relaxed at {zero}"
    }
}

fn stated(model: &Model) -> [f64; 2] {
    [model.stiffness, model.stiffness_zero]
}

/// A start of a spring whose stiffness increases with the distance from the middle of the motion.
fn hardening(e: &Evidence<'_>, stiffness: f64) -> Option<Term> {
    let s = e.scales;
    let half_span = 0.5 * s.span();
    let middle = s.middle();
    let hardening = STRONGLY_HARDENED / (half_span * half_span);
    let [pull, offset_nm] = regress(e, |m| {
        let away = m.position - middle;
        [-away * (1.0 + hardening * away * away), 1.0]
    })?;
    let pull = pull.max(0.02 * stiffness);
    let zero = middle + (offset_nm / pull).clamp(-half_span, half_span);
    let free = vec![
        guessed(0, pull, 0.05 * stiffness),
        linear(1, zero, 0.2 * s.span()),
        log(HARDENING, hardening),
    ];
    Some(term(&KIND, free, &[]))
}
