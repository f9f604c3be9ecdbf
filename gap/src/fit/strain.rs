//! How far a fit moves the model's own numbers.

use super::Fit;

/// Standard deviations of a chi-square within which the moves of the model's own numbers are likely.
const LIKELY_ERRORS: f64 = 4.0;
/// Standard deviations by which one of them moves once in 200 recordings, if it is one of five.
const STRAINED: f64 = 3.3;

impl Fit {
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
