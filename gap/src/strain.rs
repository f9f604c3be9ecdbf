//! How far a fit moves the model's own numbers, and what is found because they would have to move too far without it.

use crate::fit::Fit;
use crate::hypothesis::Nudge;
use crate::select::Round;
use std::fmt;

/// Standard deviations of a chi-square within which the moves of the model's own numbers are likely.
const LIKELY_ERRORS: f64 = 4.0;
/// Standard deviations by which one of them moves once in 200 recordings, if it is one of five.
const STRAINED: f64 = 3.3;

impl Fit {
    /// How far the model's own numbers have moved, in standard deviations.
    fn moves(&self) -> &[f64] {
        &self.x[..self.x.len() - self.hypothesis.free()]
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

/// An effect without which a number of the model would lie far from what is stated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strain {
    effect: &'static str,
    number: String,
    /// How far it would lie, in its tolerances.
    deviations: f64,
}

/// True if the effect of a round spares the model's own numbers what strained them without it.
pub(crate) fn is_relieved(round: &Round) -> bool {
    round.known.is_strained() && !round.so_far.is_strained()
}

impl Strain {
    /// What the effect of a round relieves, if it does.
    pub(crate) fn of(round: &Round, nudges: &[Nudge]) -> Option<Self> {
        let moves = nudges.iter().zip(round.known.moves());
        let (number, z) = moves.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        is_relieved(round).then(|| Self {
            effect: round.rivals[0].name,
            number: number.name.clone(),
            deviations: z.abs(),
        })
    }
}

impl fmt::Display for Strain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            effect,
            number,
            deviations,
        } = self;
        write!(
            f,
            "{effect} closes little of the gap by itself: it is named because without it {number} of the model would have to lie \
             {deviations:.1} of its tolerances from what is stated"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypothesis::Hypothesis;
    use crate::made;
    use crate::problem::Part;

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
