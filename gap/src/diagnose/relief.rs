//! What is found because the model's own numbers would have to move too far without it.

use crate::fit::hypothesis::PriorParameter;
use crate::select::Round;
use std::fmt;

/// An effect without which a number of the model would lie far from what is stated.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Relief {
    effect: &'static str,
    number: String,
    /// How far it would lie, in its tolerances.
    deviations: f64,
}

/// True if the effect of a round spares the model's own numbers what strained them without it.
pub(super) fn is_relieved(round: &Round) -> bool {
    round.known.is_strained() && !round.so_far.is_strained()
}

impl Relief {
    /// What the effect of a round relieves, if it does.
    pub(super) fn of(round: &Round, priors: &[PriorParameter]) -> Option<Self> {
        let moves = priors.iter().zip(round.known.moves());
        let (number, z) = moves.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        is_relieved(round).then(|| Self {
            effect: round.rivals[0].name,
            number: number.name.clone(),
            deviations: z.abs(),
        })
    }
}

impl fmt::Display for Relief {
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
