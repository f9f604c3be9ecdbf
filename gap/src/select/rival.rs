//! A hypothesis with one more effect.

use crate::fit::Fit;
use crate::hypothesis::{Hypothesis, Term};

/// A hypothesis that was tried in addition to what was known.
#[derive(Clone, Debug)]
pub(crate) struct Rival {
    pub name: &'static str,
    pub fit: Fit,
}

impl Rival {
    pub(super) fn parameters(&self) -> usize {
        self.fit.hypothesis.free()
    }

    /// Coordinates of what stands beside its last effect.
    pub(super) fn held(&self) -> Option<usize> {
        let last = self.fit.hypothesis.terms.last()?;
        self.fit.x.len().checked_sub(last.free.len())
    }

    /// The same, begun with the numbers that its last effect shares with that of another, if there are any.
    pub(super) fn alike(&self, other: &Self) -> Option<Self> {
        let term = self.fit.last_term()?.alike(&other.fit.last_term()?)?;
        let mut alike = self.clone();
        let held = self.held()?;
        *alike.fit.hypothesis.terms.last_mut()? = term;
        alike.fit.x[held..].fill(0.0);
        Some(alike)
    }
}

/// `known` with one more term, at the point where both stand.
pub(super) fn extended(known: &Fit, term: &Term) -> (Hypothesis, Vec<f64>) {
    let mut hypothesis = known.hypothesis.clone();
    hypothesis.terms.push(term.clone());
    let mut x = known.x.clone();
    x.extend(term.free.iter().map(|_| 0.0));
    (hypothesis, x)
}

/// A rival of two effects on top of `null` in the other order.
pub(super) fn turned(both: &Rival, null: &Fit) -> Option<Rival> {
    let mut fit = both.fit.clone();
    let nudges = null.x.len();
    let [first, _] = &fit.hypothesis.terms[..] else {
        return None;
    };
    let split = first.free.len();
    let name = first.kind.name;
    fit.hypothesis.terms.swap(0, 1);
    fit.x[nudges..].rotate_left(split);
    fit.std[nudges..].rotate_left(split);
    Some(Rival { name, fit })
}
