//! Effects that a user writes down as an expression, without Rust.
//!
//! ```toml
//! name = "eddy_brake"
//! about = "a brake by eddy currents, whose torque falls at speed"
//! torque = "-k * v / (1 + (v / v0)^2)"
//!
//! [parameters.k]
//! typical = [1e-5, 1e-2]
//! quantity = "damping"
//!
//! [parameters.v0]
//! typical = [1.0, 50.0]
//! quantity = "velocity"
//! ```

mod definition;
mod error;
mod expression;

use super::identification::Identification;
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{geometric, linear, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::Form;
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use definition::Definition;
pub use error::OwnEffectError;
use expression::Expression;
use host_sim::effects::Kind;
use host_sim::effects::own::{OwnKind, add as add_kind};
use std::sync::{PoisonError, RwLock};

/// Number of start values of each parameter, by the number of parameters.
const STARTS_PER_PARAMETER: [usize; 5] = [0, 5, 3, 2, 2];

static OWN: RwLock<Vec<&'static OwnEffect>> = RwLock::new(Vec::new());

/// An effect that a user defined.
#[derive(Debug)]
pub(super) struct OwnEffect {
    kind: &'static Kind,
    axis: Axis,
}

/// Adds the effect that a TOML text defines to the vocabulary, until the program ends, and returns its name. The effect is then searched,
/// reported, saved and read like any other.
///
/// # Errors
///
/// [`OwnEffectError`] for a text that does not define an effect.
pub fn add_own(text: &str) -> Result<&'static str, OwnEffectError> {
    let own = Definition::read(text)?;
    let names: Vec<String> = own.parameters.keys().cloned().collect();
    let law = Expression::compiled(&own.torque, &names)?;
    let kind = add_kind(OwnKind {
        equation: format!("T = {}", own.torque),
        parameters: own.parameters(),
        law: Box::new(law),
        name: own.name,
        about: own.about,
    })?;
    let effect: &'static OwnEffect = Box::leak(Box::new(OwnEffect {
        kind,
        axis: own.axis.into(),
    }));
    let mut all = OWN.write().unwrap_or_else(PoisonError::into_inner);
    all.push(effect);
    Ok(kind.name)
}

/// All effects that were added.
pub(super) fn all() -> Vec<&'static dyn Identification> {
    let all = OWN.read().unwrap_or_else(PoisonError::into_inner);
    all.iter().map(|own| *own as &dyn Identification).collect()
}

impl OwnEffect {
    /// Sets of parameter values within their typical ranges.
    fn sets(&self) -> Vec<Vec<f64>> {
        let parameters = self.kind.parameters;
        let count = STARTS_PER_PARAMETER[parameters.len().min(STARTS_PER_PARAMETER.len() - 1)];
        let mut sets = vec![Vec::new()];
        for parameter in parameters {
            let [low, high] = parameter.typical;
            let values: Vec<f64> = if low > 0.0 {
                geometric([low, high], count).collect()
            } else {
                let step = (high - low) / (count + 1) as f64;
                (1..=count).map(|k| low + step * k as f64).collect()
            };
            let with = |set: &Vec<f64>| {
                let longer = values.iter().map(|value| [&set[..], &[*value]].concat());
                longer.collect::<Vec<_>>()
            };
            sets = sets.iter().flat_map(with).collect();
        }
        sets
    }

    /// Coordinates of all parameters with the given start values.
    fn coordinates(&self, values: &[f64]) -> Vec<Coordinate> {
        let all = self.kind.parameters.iter().zip(values).enumerate();
        all.map(|(place, (parameter, &value))| {
            let [low, high] = parameter.typical;
            if low > 0.0 {
                log(place, value)
            } else {
                linear(place, value, 0.25 * (high - low))
            }
        })
        .collect()
    }
}

impl Identification for OwnEffect {
    fn kind(&self) -> &'static Kind {
        self.kind
    }

    fn starts(&self, _evidence: &Evidence<'_>) -> Vec<Term> {
        let sets = self.sets().into_iter();
        sets.map(|values| term(self.kind, self.coordinates(&values), &[]))
            .collect()
    }

    fn axis(&self) -> Axis {
        self.axis
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let sets = self.sets().into_iter();
        let searched = self.kind.parameters.len();
        let forms = sets.map(|values| {
            Form::whole(path, self.kind, values, None)
                .searched(searched)
                .positive()
        });
        target.screened(forms.collect(), 1)
    }

    fn noun(&self) -> &'static str {
        self.kind.about
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        self.kind.about
    }
}
