//! Effects that are found because a model parameter would deviate too far from its stated value without them.

use crate::fit::hypothesis::PriorParameter;
use crate::select::Round;
use std::fmt;

/// An effect without which a model parameter would deviate far from its stated value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PriorTension {
    effect: &'static str,
    number: String,
    /// Deviation of the parameter without the effect, in its standard deviations.
    deviations: f64,
}

/// True if the fit is strained without the effect of a round, and not with it.
pub(super) fn relieves_tension(round: &Round) -> bool {
    round.known.is_strained() && !round.so_far.is_strained()
}

impl PriorTension {
    /// The parameter that deviates most without the effect of a round, if the effect relieves it.
    pub(super) fn of(round: &Round, priors: &[PriorParameter]) -> Option<Self> {
        let moves = priors.iter().zip(round.known.moves());
        let (number, z) = moves.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        relieves_tension(round).then(|| Self {
            effect: round.rivals[0].name,
            number: number.name.clone(),
            deviations: z.abs(),
        })
    }
}

impl fmt::Display for PriorTension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            effect,
            number,
            deviations,
        } = self;
        write!(
            f,
            "{effect} closes little of the gap by itself: it is named because without it {number} of the model would deviate by \
             {deviations:.1} of its tolerances from the stated value"
        )
    }
}
