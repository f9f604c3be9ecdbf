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
    /// An instant, to be rounded to a tenth of the duration of the interval that it begins or ends.
    Instant {
        /// The instant.
        at: Estimate,
        /// Duration of the interval, in the unit of the instant.
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

/// The properties of the nominal model on which the sentences about its effects depend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Coulomb friction torque at the joint.
    pub coulomb: f64,
    /// Limit of the input, in input units.
    pub input_limit: Option<f64>,
    /// True if the model has hard stops.
    pub has_stops: bool,
    /// True if the recording has several runs.
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

    /// Magnitude of a negative parameter, which shortens a time of the model. Returns `None` if it is not negative.
    pub(crate) fn shortened_by(&self, name: &str) -> Option<Estimate> {
        let shorter = self
            .estimate(name)
            .filter(|estimate| estimate.value < 0.0)?;
        Some(Estimate {
            value: -shorter.value,
            ..shorter.clone()
        })
    }

    /// Number of parameters whose names begin with `name`. It is the number of occurrences of an event.
    pub(crate) fn count(&self, name: &str) -> usize {
        let names = self.finding.parameters.keys();
        names.filter(|n| n.starts_with(name)).count()
    }

    /// A template filled with its values. Returns `None` if one of them was not found.
    pub(crate) fn filled(&self, template: &'static str) -> Option<Phrase> {
        self.filled_by(template, |_, estimate| Part::Number(estimate.clone()))
    }

    /// A template filled with its values, each written by `written` with the name of its parameter. Returns `None` if one of them was not
    /// found.
    pub(crate) fn filled_by(
        &self,
        template: &'static str,
        written: impl Fn(&str, &Estimate) -> Part,
    ) -> Option<Phrase> {
        let mut parts = Vec::new();
        let mut rest = template;
        while let Some((before, after)) = rest.split_once('{') {
            let (name, after) = after.split_once('}')?;
            parts.push(Part::Words(before.into()));
            parts.push(written(name, self.estimate(name)?));
            rest = after;
        }
        parts.push(Part::Words(rest.into()));
        Some(Phrase(parts))
    }
}
