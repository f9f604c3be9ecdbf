//! A rival is a hypothesis with one more effect than the model so far.

use super::excess::level;
use crate::fit::Fit;
use crate::fit::hypothesis::Hypothesis;
use crate::term::Term;

/// A fit of the model so far with one more effect, which is its last term.
#[derive(Clone, Debug)]
pub(crate) struct Rival {
    pub name: &'static str,
    pub fit: Fit,
}

impl Rival {
    /// Returns true if its last effect is bound to instants of one recording.
    pub(crate) fn is_event(&self) -> bool {
        self.fit.hypothesis.terms.last().is_some_and(Term::is_event)
    }

    pub(super) fn parameters(&self) -> usize {
        self.fit.hypothesis.free()
    }

    /// Returns the number of coordinates before those of its last effect.
    pub(super) fn held(&self) -> Option<usize> {
        let last = self.fit.hypothesis.terms.last()?;
        self.fit.x.len().checked_sub(last.free.len())
    }

    /// Returns the rival with another start of its last effect. The function `made` makes that start from the last effects of this and the
    /// other rival.
    pub(super) fn starting_like(
        &self,
        other: &Self,
        made: impl Fn(&Term, &Term) -> Option<Term>,
    ) -> Option<Self> {
        let term = made(&self.fit.last_term()?, &other.fit.last_term()?)?;
        self.starting_with(term)
    }

    /// Returns the rival with one parameter of its last effect fixed at a value. Returns `None` if that parameter is not free.
    pub(super) fn with_held(&self, parameter: usize, value: f64) -> Option<Self> {
        let last = self.fit.last_term()?;
        let place = last.free.iter().position(|c| c.parameter == parameter)?;
        let mut held = self.starting_with(last.held(parameter, value))?;
        held.fit.x.remove(self.held()? + place);
        Some(held)
    }

    /// Returns the rival with another start of its last effect.
    fn starting_with(&self, term: Term) -> Option<Self> {
        let held = self.held()?;
        let mut started = self.clone();
        *started.fit.hypothesis.terms.last_mut()? = term;
        started.fit.x[held..].fill(0.0);
        Some(started)
    }
}

/// Returns the hypothesis of `known` with additional terms, and its coordinates. The new terms are at their starts.
pub(super) fn extended<'a>(
    known: &Fit,
    terms: impl IntoIterator<Item = &'a Term>,
) -> (Hypothesis, Vec<f64>) {
    let mut hypothesis = known.hypothesis.clone();
    let mut x = known.x.clone();
    for term in terms {
        hypothesis.terms.push(term.clone());
        x.extend(term.free.iter().map(|_| 0.0));
    }
    (hypothesis, x)
}

/// Returns the rival of lowest cost.
pub(super) fn best_of(rivals: &[Rival]) -> Option<&Rival> {
    rivals
        .iter()
        .min_by(|a, b| level(&a.fit).total_cmp(&level(&b.fit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::costs::Costs;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    /// A rival of one effect at the coordinates `x`.
    fn rival(name: &str, free: &[Coordinate], x: &[f64]) -> Rival {
        let term = made::term(name, free);
        let name = term.kind.name;
        let fit = Fit {
            hypothesis: Hypothesis { terms: vec![term] },
            x: x.to_vec(),
            std: vec![0.0; x.len()],
            costs: Costs {
                per_sample: Vec::new(),
                prior: 0.0,
            },
        };
        Rival { name, fit }
    }

    #[test]
    fn a_fixed_parameter_is_no_longer_free() {
        let free = |parameter| Coordinate {
            parameter,
            start: 0.02,
            scale: Scale::Linear(0.01),
        };
        let found = rival("gravity", &[free(0), free(1)], &[1.0, 2.0]);
        let held = found.with_held(1, 0.3).unwrap();
        let term = held.fit.last_term().unwrap();
        assert!((term.values[0] - 0.03).abs() < 1e-12 && term.values[1] == 0.3);
        assert_eq!((held.fit.x, term.free.len()), (vec![0.0], 1));
        assert!(
            rival("gravity", &[free(0)], &[1.0])
                .with_held(1, 0.3)
                .is_none()
        );
    }
}
