//! Inertia and what pulls at it.

use super::Evidence;
use super::regression::regress;
use super::start::{guessed, linear, log, term, terms};
use super::{stops, transmission};
use crate::fit::hypothesis::{Coordinate, Term};
use host_sim::effects::Kind;

/// Which of a spring's numbers says how it hardens, and the share by which it may at the ends of the motion.
const HARDENING: usize = 2;
const HARDENED: f64 = 0.3;
/// The same of one that hardens strongly.
const STEEP: f64 = 3.0;

pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let m = &e.device.mechanics;
    match kind.name {
        "inertia" => {
            let guess = regress(e, |m| [-m.acceleration]);
            let guess = guess.map(|[j]| vec![log(0, (m.inertia + j).max(0.1 * m.inertia))]);
            terms(kind, guess, [vec![log(0, m.inertia)]])
        }
        "gravity" => {
            let angle_rad = m.angle_rad;
            let guess = regress(e, |m| {
                let (sin, cos) = (angle_rad * m.position).sin_cos();
                [-sin, cos]
            });
            let guess = guess.map(|[a, b]| {
                let (sin, cos) = (angle_rad * m.gravity_zero).sin_cos();
                let (a, b) = (a + m.gravity * cos, b + m.gravity * sin);
                let weight = guessed(0, a.hypot(b), 0.1 * s.torque);
                vec![weight, linear(1, b.atan2(a) / angle_rad, 0.1 / angle_rad)]
            });
            let hanging = vec![
                linear(0, m.gravity, 0.1 * s.torque),
                linear(1, m.gravity_zero, 0.1 * s.span().min(1.0 / angle_rad)),
            ];
            terms(kind, guess, [hanging])
        }
        "spring" => {
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
            let soft = vec![
                linear(0, m.stiffness + 0.05 * stiffness, 0.1 * stiffness),
                linear(1, zero, 0.2 * s.span()),
            ];
            let mut starts = terms(kind, guess, [soft]);
            if m.stiffness == 0.0 {
                starts.extend(hardening(kind, e, stiffness));
            }
            starts
        }
        "end_stop" => stops::starts(kind, e),
        "backlash" => transmission::plays(kind, e),
        "compliance" => transmission::springs(kind, e),
        _ => Vec::new(),
    }
}

/// A spring that hardens as strongly as it pulls about the middle of the motion, about there.
fn hardening(kind: &'static Kind, e: &Evidence<'_>, stiffness: f64) -> Option<Term> {
    let s = e.scales;
    let half_span = 0.5 * s.span();
    let middle = s.middle();
    let hardening = STEEP / (half_span * half_span);
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
    Some(term(kind, free, &[]))
}

/// How a spring hardens, where that was given.
pub(super) fn shape(given: &Term, half_span: f64) -> Option<Vec<Coordinate>> {
    let is_spring = given.kind.name == "spring" && !given.is_free(HARDENING);
    is_spring.then(|| vec![log(HARDENING, HARDENED / (half_span * half_span))])
}
