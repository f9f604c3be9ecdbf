//! A fitted hypothesis, and how far it moves the model parameters.

use super::costs::Costs;
use super::hypothesis::Hypothesis;
use crate::term::Term;

/// Number of standard deviations of χ² within which the deviations of the model parameters are plausible.
const LIKELY_ERRORS: f64 = 4.0;
/// Number of standard deviations that one of five model parameters exceeds by chance in one of 200 recordings.
const STRAINED: f64 = 3.3;

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub hypothesis: Hypothesis,
    pub x: Vec<f64>,
    /// Standard deviation of each coordinate.
    pub std: Vec<f64>,
    pub costs: Costs,
}

impl Fit {
    /// The last effect, with its fitted values as start values.
    pub(crate) fn last_term(&self) -> Option<Term> {
        let (term, own) = self.hypothesis.parts(&self.x).last()?;
        Some(term.moved(own))
    }

    /// The effects with more free parameters of the last one, as given by `more`, and the extended coordinates. Returns `None` if there
    /// is no effect or nothing to free.
    pub(crate) fn loosened(
        &self,
        more: impl Fn(&Term) -> Option<Term>,
    ) -> Option<(Hypothesis, Vec<f64>)> {
        let mut hypothesis = self.hypothesis.clone();
        let last = hypothesis.terms.last_mut()?;
        *last = more(last)?;
        let mut x = self.x.clone();
        x.resize(
            self.x.len() - self.hypothesis.free() + hypothesis.free(),
            0.0,
        );
        Some((hypothesis, x))
    }

    /// The effects with the last one replaced by `term`, and the coordinates to start a fit from.
    pub(crate) fn with_last(&self, term: Term) -> (Hypothesis, Vec<f64>) {
        let (mut hypothesis, mut x) = self.hypothesis.moved(&self.x);
        let before = hypothesis.terms.pop().map_or(0, |term| term.free.len());
        x.resize(x.len() + term.free.len() - before, 0.0);
        hypothesis.terms.push(term);
        (hypothesis, x)
    }

    /// The effects without the one at `place`, and the coordinates without those of that effect.
    pub(crate) fn without(&self, place: usize) -> (Hypothesis, Vec<f64>) {
        let parts = self.hypothesis.parts(&self.x).enumerate();
        let kept = parts.filter(|(i, _)| *i != place);
        let (terms, own): (_, Vec<_>) = kept.map(|(_, (term, own))| (term.clone(), own)).unzip();
        let mut x = self.x[..self.x.len() - self.hypothesis.free()].to_vec();
        x.extend(own.concat());
        (Hypothesis { terms }, x)
    }

    /// Deviations of the model parameters from their stated values, in standard deviations.
    pub(crate) fn moves(&self) -> &[f64] {
        &self.x[..self.x.len() - self.hypothesis.free()]
    }

    /// The fit with the model parameters at their stated values.
    pub(crate) fn as_stated(&self) -> Self {
        let mut stated = self.clone();
        stated.x[..self.moves().len()].fill(0.0);
        stated
    }

    /// True if the deviations of the model parameters are plausible for their tolerances.
    pub(crate) fn is_likely(&self) -> bool {
        let moves = self.moves();
        let squares: f64 = moves.iter().map(|z| z * z).sum();
        let numbers = moves.len() as f64;
        squares <= numbers + LIKELY_ERRORS * (2.0 * numbers).sqrt()
    }

    /// True if the deviations of the model parameters together, or one of them alone, are so large that they seem to compensate another
    /// error.
    pub(crate) fn is_strained(&self) -> bool {
        !self.is_likely() || self.moves().iter().any(|z| z.abs() > STRAINED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;

    /// Whether a fit with these deviations is likely, and whether it is strained.
    fn likely_and_strained(moves: &[f64]) -> [bool; 2] {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let fit = problem.fit(&bare, Vec::new(), Part::All, 0);
        let x = moves.to_vec();
        let fit = Fit { x, ..fit };
        [fit.is_likely(), fit.is_strained()]
    }

    #[test]
    fn one_large_deviation_strains_a_model_that_is_likely_overall() {
        assert_eq!(likely_and_strained(&[]), [true, false]);
        assert_eq!(likely_and_strained(&[2.0, -2.0, 1.0]), [true, false]);
        assert_eq!(likely_and_strained(&[0.1, -3.5, 0.2]), [true, true]);
        assert_eq!(likely_and_strained(&[3.0, -3.0, 3.0]), [false, true]);
    }
}
