//! Dry friction as bristles that bend before they slide.

use super::identification::{Identification, Landscape};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::sliding::has_coulomb_friction;
use crate::guess::start::{guessed, linear, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::{Path, sign};
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::series::FINE_PERIOD_S;
use host_sim::effects::Kind;
use host_sim::effects::presliding::KIND;

/// Natural frequency of bristles, in rad a coarse sample.
const RESOLVED_RATE: f64 = 2.0;
/// How far they bend, over the span of the motion: from those that are hardly softer than stick on.
const BENDS: [f64; 6] = [3e-5, 3e-4, 0.003, 0.015, 0.06, 0.2];
/// Their damping over that of the springs that bend alike, as a share of the critical one.
const BRISTLE_DAMPING: f64 = 0.3;
/// How far bristles bend before they slide, over half of the span, as screened for the missing torque.
const BENDS_SCREENED: [f64; 8] = [0.004, 0.008, 0.015, 0.03, 0.055, 0.1, 0.16, 0.25];

#[derive(Debug)]
pub(super) struct Presliding;

impl Identification for Presliding {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        if !has_coulomb_friction(e) {
            return Vec::new();
        }
        BENDS.iter().flat_map(|&f| bristles(e, f)).collect()
    }

    fn landscape(&self) -> Landscape {
        Landscape::Hysteretic
    }

    fn reformulates_friction(&self) -> bool {
        true
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        if path.friction_level() == 0.0 {
            return Vec::new();
        }
        let distances = BENDS_SCREENED.map(|part| part * path.scale.half_span());
        let forms = distances.map(|distance| {
            Form::new(vec![not_held(path, distance)], move |_| {
                with_defaults(&KIND, &[(0, distance), (1, 0.0)])
            })
            .searched(1)
            .positive()
        });
        target.screened(forms.into(), 2)
    }

    fn noun(&self) -> &'static str {
        "presliding"
    }

    fn tell_apart(&self) -> &'static str {
        "After a reversal the torque builds up over a distance, not at once. A hysteresis of the sensor has the same loop, but in the reading. Record small motion around several places."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "presliding (dry friction that gives way by {distance} before it slides)"
    }
}

/// Bristles that bend by a share of the span of the motion, and what they lose by sliding or by bending.
fn bristles(e: &Evidence<'_>, bend: f64) -> [Term; 2] {
    let inertia = e.device.mechanics.inertia;
    let level = e.device.mechanics.friction.highest_nm();
    // Bristles that ring faster than samples follow are stick.
    let stiffest = inertia * (RESOLVED_RATE / e.scales.period_s.max(FINE_PERIOD_S)).powi(2);
    let distance = (bend * e.scales.span()).max(level / stiffest);
    let much = BRISTLE_DAMPING * 2.0 * (level / distance * inertia).sqrt();
    // They may not damp at all.
    let damping = guessed(1, much, 0.0);
    [log(2, 0.7), linear(3, 0.4, 0.2)]
        .map(|last| term(&KIND, vec![log(0, distance), damping, last], &[]))
}

/// What bristles that bend so far do not yet hold of the dry friction, per step.
fn not_held(path: &Path<'_>, distance: f64) -> Vec<f64> {
    let levels = path.device.mechanics.friction.level_nm;
    let mut bent = 0.0f64;
    let steps = (0..path.position.len()).map(|i| {
        let step_s = path.samples.step_s[i];
        if step_s == 0.0 {
            bent = 0.0;
            return 0.0;
        }
        let passed = path.velocity[i] * step_s / distance;
        let before = bent;
        // Dahl's bristles: s' = x'(1 − s sgn x')/z, in one step.
        let way = sign(passed);
        bent = way + (bent - way) * (-passed.abs()).exp();
        let held = 0.5 * (before + bent);
        let full = if path.direction[i] < 0.0 {
            levels[1]
        } else {
            levels[0]
        };
        full * (path.direction[i] - held)
    });
    steps.collect()
}
