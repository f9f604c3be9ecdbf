//! Friction in proportion to velocity.

use super::identification::{Family, Identification};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::regression::regress;
use crate::guess::start::{guessed, linear, terms};
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::viscous::KIND;

#[derive(Debug)]
pub(super) struct Viscous;

impl Identification for Viscous {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let stated = e.device.mechanics.viscous;
        let scale = 0.1 * e.scales.torque / e.scales.velocity;
        let guess = regress(e, |m| [-m.velocity]);
        let guess = guess.map(|[b]| vec![guessed(0, (stated + b).max(0.0), scale)]);
        terms(&KIND, guess, [vec![linear(0, stated, scale)]])
    }

    fn family(&self) -> Option<Family> {
        Some(Family::Drag)
    }

    fn noun(&self) -> &'static str {
        "viscous friction"
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "viscous friction of {coefficient}"
    }
}
