//! A sentence about an effect, before its numbers are written out.

use crate::diagnosis::{Estimate, Finding};
use std::borrow::Cow;

/// Words and numbers of a sentence about a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Phrase(pub Vec<Part>);

/// Words or a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// Words.
    Words(Cow<'static, str>),
    /// A number, to be written with its unit.
    Number(Estimate),
    /// An instant, to be written to a tenth of the duration of the stay that begins or ends then.
    Instant {
        /// The instant.
        at: Estimate,
        /// The duration, in the unit of the instant.
        lasts: f64,
    },
}

impl Phrase {
    /// Words alone.
    pub(crate) fn of(words: impl Into<Cow<'static, str>>) -> Self {
        Self(vec![Part::Words(words.into())])
    }

    /// This phrase with more words at its end.
    pub(crate) fn then(mut self, words: &'static str) -> Self {
        self.0.push(Part::Words(words.into()));
        self
    }
}

/// The facts of a recording's nominal model on which sentences about its effects depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Dry friction, torque at the joint.
    pub coulomb: f64,
    /// Largest input, in units of the input.
    pub input_limit: Option<f64>,
    /// True if it has hard stops.
    pub has_stops: bool,
    /// True if there are several runs.
    pub has_runs: bool,
}

/// A finding, with the nominal model that it changes.
pub(crate) struct Found<'a> {
    pub finding: &'a Finding,
    pub nominal: &'a Nominal,
}

impl Found<'_> {
    /// The parameter `name`.
    pub(crate) fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.finding.parameters.get(name)
    }

    /// The value of the parameter `name`.
    pub(crate) fn value(&self, name: &str) -> Option<f64> {
        self.estimate(name).map(|estimate| estimate.value)
    }

    /// The parameter `name` if it was fitted.
    pub(crate) fn fitted(&self, name: &str) -> Option<&Estimate> {
        self.estimate(name).filter(|estimate| estimate.is_fitted)
    }

    /// Size of a negative parameter, which shortens something of the model; `None` if it is not negative.
    pub(crate) fn shortened_by(&self, name: &str) -> Option<Estimate> {
        let shorter = self
            .estimate(name)
            .filter(|estimate| estimate.value < 0.0)?;
        Some(Estimate {
            value: -shorter.value,
            ..shorter.clone()
        })
    }

    /// Number of parameters whose names begin with `name`: how often an event happens.
    pub(crate) fn count(&self, name: &str) -> usize {
        let names = self.finding.parameters.keys();
        names.filter(|n| n.starts_with(name)).count()
    }

    /// A template with its numbers; `None` if one of them was not found.
    pub(crate) fn filled(&self, template: &'static str) -> Option<Phrase> {
        self.filled_by(template, |_, estimate| Part::Number(estimate.clone()))
    }

    /// A template with its numbers, each as `said` by the name of its parameter; `None` if one of them was not found.
    pub(crate) fn filled_by(
        &self,
        template: &'static str,
        said: impl Fn(&str, &Estimate) -> Part,
    ) -> Option<Phrase> {
        let mut parts = Vec::new();
        let mut rest = template;
        while let Some((before, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}')?;
            parts.push(Part::Words(before.into()));
            parts.push(said(name, self.estimate(name)?));
            rest = after;
        }
        parts.push(Part::Words(rest.into()));
        Some(Phrase(parts))
    }
}
