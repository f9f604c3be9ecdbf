//! Drag with the square of the speed.

use super::identification::{Family, Identification};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, terms};
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::quadratic_drag::KIND;

#[derive(Debug)]
pub(super) struct QuadraticDrag;

impl Identification for QuadraticDrag {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let scale = 0.1 * e.scales.torque / e.scales.velocity.powi(2);
        let guess = regress(e, |m| [-m.velocity * m.velocity.abs()]);
        let guess = guess.map(|[q]| vec![guessed(0, q.max(0.0), scale)]);
        terms(&KIND, guess, [vec![linear(0, 0.0, scale)]])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Drag)
    }

    fn noun(&self) -> &'static str {
        "quadratic drag"
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "drag of {coefficient} times the square of the speed"
    }
}
