//! Dry friction as bristles that bend before they slide.

use super::identification::{Identification, Landscape};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::sliding::is_dry;
use crate::guess::start::{guessed, linear, log, term};
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

#[derive(Debug)]
pub(super) struct Presliding;

impl Identification for Presliding {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        if !is_dry(e) {
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

    fn noun(&self) -> &'static str {
        "presliding"
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
