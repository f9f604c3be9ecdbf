//! A fitted hypothesis, and how far it moves the model's own numbers.

use super::costs::Costs;
use super::hypothesis::Hypothesis;
use crate::term::Term;

/// Standard deviations of a chi-square within which the moves of the model's own numbers are likely.
const LIKELY_ERRORS: f64 = 4.0;
/// Standard deviations by which one of them moves once in 200 recordings, if it is one of five.
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
    /// Its last effect as it was fitted, as a place to start from.
    pub(crate) fn last_term(&self) -> Option<Term> {
        let (term, own) = self.hypothesis.parts(&self.x).last()?;
        Some(term.moved(own))
    }

    /// Its effects with more of the last one free, and the coordinates with as many more.
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

    /// Its effects with another term in the place of the last, and coordinates to fit them from.
    pub(crate) fn with_last(&self, term: Term) -> (Hypothesis, Vec<f64>) {
        let (mut hypothesis, mut x) = self.hypothesis.moved(&self.x);
        let before = hypothesis.terms.pop().map_or(0, |term| term.free.len());
        x.resize(x.len() + term.free.len() - before, 0.0);
        hypothesis.terms.push(term);
        (hypothesis, x)
    }

    /// Its effects without one of them, and the coordinates without its own.
    pub(crate) fn without(&self, place: usize) -> (Hypothesis, Vec<f64>) {
        let parts = self.hypothesis.parts(&self.x).enumerate();
        let kept = parts.filter(|(i, _)| *i != place);
        let (terms, own): (_, Vec<_>) = kept.map(|(_, (term, own))| (term.clone(), own)).unzip();
        let mut x = self.x[..self.x.len() - self.hypothesis.free()].to_vec();
        x.extend(own.concat());
        (Hypothesis { terms }, x)
    }

    /// How far the model's own numbers have moved, in standard deviations.
    pub(crate) fn moves(&self) -> &[f64] {
        &self.x[..self.x.len() - self.hypothesis.free()]
    }

    /// The same with the model's own numbers as they are stated.
    pub(crate) fn as_stated(&self) -> Self {
        let mut stated = self.clone();
        stated.x[..self.moves().len()].fill(0.0);
        stated
    }

    /// True if the model's own numbers have moved no farther than their tolerances let one expect.
    pub(crate) fn is_likely(&self) -> bool {
        let moves = self.moves();
        let squares: f64 = moves.iter().map(|z| z * z).sum();
        let numbers = moves.len() as f64;
        squares <= numbers + LIKELY_ERRORS * (2.0 * numbers).sqrt()
    }

    /// True if they, or one of them alone, have moved so far that they seem to make up for something else.
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

    /// Whether numbers that have moved so far are likely, and whether they are strained.
    fn told(moves: &[f64]) -> [bool; 2] {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let fit = problem.fit(&bare, Vec::new(), Part::All, 0);
        let x = moves.to_vec();
        let fit = Fit { x, ..fit };
        [fit.is_likely(), fit.is_strained()]
    }

    #[test]
    fn one_number_that_goes_far_strains_a_model_whose_numbers_are_likely_together() {
        assert_eq!(told(&[]), [true, false]);
        assert_eq!(told(&[2.0, -2.0, 1.0]), [true, false]);
        assert_eq!(told(&[0.1, -3.5, 0.2]), [true, true]);
        assert_eq!(told(&[3.0, -3.0, 3.0]), [false, true]);
    }
}
