//! Coulomb friction with a different level.

use super::identification::{Identification, MainNumber};
use super::phrase::{Found, Part, Phrase};
use crate::diagnosis::Estimate;
use crate::guess::Evidence;
use crate::guess::balance::Balance;
use crate::guess::regression::regress;
use crate::guess::start::{linear, log, terms};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use host_sim::effects::Kind;
use host_sim::effects::coulomb::KIND;

/// Share of the nominal level below which the friction counts as absent.
const INERT: f64 = 0.01;

#[derive(Debug)]
pub(super) struct Coulomb;

impl Identification for Coulomb {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let level = e.device.mechanics.friction.level_nm;
        let guess = regress(e, |m| [-m.velocity.signum()]);
        let guess = guess.map(|[f]| vec![log(0, (level[0] + f).max(0.05 * s.friction))]);
        // Only a linear coordinate can reach the level 0.
        let none = vec![linear(0, 0.02 * s.friction, 0.1 * s.friction)];
        let [less, more] = [0.6, 1.4].map(|f| vec![log(0, f * s.friction)]);
        terms(&KIND, guess, [less, more, none])
    }

    fn main_number(&self) -> Option<MainNumber> {
        Some(MainNumber {
            name: "coulomb",
            usual_error: Some(0.1),
        })
    }

    fn balanced(&self, own: &Term, balance: &Balance) -> Term {
        own.starting_at(&[(0, balance.coulomb)])
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, _target: &Target<'_>) -> Vec<Form> {
        let level = path.friction_level();
        vec![Form::linear(
            path,
            &KIND,
            &[level],
            &[(0, path.scale.torque_step())],
        )]
    }

    fn noun(&self) -> &'static str {
        "another level of dry friction"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a step at each reversal, of one height at all speeds. Viscous friction has a slope, static friction a peak at the reversal. Record slow and fast motion."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "dry friction of {level}"
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        let Some(level) = found.estimate("level") else {
            return self.filled_template(found);
        };
        if found.nominal.coulomb <= 0.0 {
            return self.filled_template(found);
        }
        let nominal = Part::Number(Estimate {
            value: found.nominal.coulomb,
            ..level.clone()
        });
        if level.value < INERT * found.nominal.coulomb {
            return Phrase(vec![
                Part::Words("dry friction that does not act (none of the ".into()),
                nominal,
                Part::Words(")".into()),
            ]);
        }
        Phrase(vec![
            Part::Words("dry friction of ".into()),
            Part::Number(level.clone()),
            Part::Words(" in place of ".into()),
            nominal,
        ])
    }
}
