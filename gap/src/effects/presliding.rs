//! Presliding: Coulomb friction as bristles that deflect before they slide.

use super::identification::{Fitted, Identification, Landscape};
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

/// Highest natural frequency of the bristles, rad per coarse sample.
const RESOLVED_RATE: f64 = 2.0;
/// Deflections of the bristles at the start, over the range of the motion. The smallest one acts nearly like rigid sticking.
const DEFLECTIONS: [f64; 6] = [3e-5, 3e-4, 0.003, 0.015, 0.06, 0.2];
/// Damping of the bristles at the start, as a share of the critical damping.
const BRISTLE_DAMPING: f64 = 0.3;
/// Deflections that are screened for the missing torque, over half of the range of the motion.
const DEFLECTIONS_SCREENED: [f64; 8] = [0.004, 0.008, 0.015, 0.03, 0.055, 0.1, 0.16, 0.25];

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
        DEFLECTIONS.iter().flat_map(|&f| bristles(e, f)).collect()
    }

    fn landscape(&self) -> Landscape {
        Landscape::Hysteretic
    }

    fn reformulates_friction(&self) -> bool {
        true
    }

    /// Bristles that deflect by less than the resolution of the position sensor are not observable.
    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        fit.term.values[0] < fit.resolution
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        if path.friction_level() == 0.0 {
            return Vec::new();
        }
        let distances = DEFLECTIONS_SCREENED.map(|part| part * path.scale.half_span());
        let forms = distances.map(|distance| {
            Form::new(vec![friction_deficit(path, distance)], move |_| {
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

/// Starts with a deflection of a share of the range of the motion: one with a free exponent, and one with a free elastic part of the
/// deflection, in which nothing slides.
fn bristles(e: &Evidence<'_>, deflection_share: f64) -> [Term; 2] {
    let inertia = e.device.mechanics.inertia;
    let level = e.device.mechanics.friction.highest_nm();
    // Bristles with a higher natural frequency than the samples resolve act like rigid sticking.
    let stiffest = inertia * (RESOLVED_RATE / e.scales.period_s.max(FINE_PERIOD_S)).powi(2);
    let distance = (deflection_share * e.scales.span()).max(level / stiffest);
    let damping_scale = BRISTLE_DAMPING * 2.0 * (level / distance * inertia).sqrt();
    // The damping may be zero.
    let damping = guessed(1, damping_scale, 0.0);
    [log(2, 0.7), linear(3, 0.4, 0.2)]
        .map(|last| term(&KIND, vec![log(0, distance), damping, last], &[]))
}

/// The part of the Coulomb friction that the bristles do not transmit yet, over each step.
fn friction_deficit(path: &Path<'_>, distance: f64) -> Vec<f64> {
    let levels = path.device.mechanics.friction.level_nm;
    let mut deflection = 0.0f64;
    let steps = (0..path.position.len()).map(|i| {
        let step_s = path.samples.step_s[i];
        if step_s == 0.0 {
            deflection = 0.0;
            return 0.0;
        }
        let passed = path.velocity[i] * step_s / distance;
        let before = deflection;
        // One step of the model of Dahl: s' = x'(1 − s sgn x')/z.
        let direction = sign(passed);
        deflection = direction + (deflection - direction) * (-passed.abs()).exp();
        let transmitted = 0.5 * (before + deflection);
        let full = if path.direction[i] < 0.0 {
            levels[1]
        } else {
            levels[0]
        };
        full * (path.direction[i] - transmitted)
    });
    steps.collect()
}
