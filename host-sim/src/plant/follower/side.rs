//! How one side of a plant moves as far as dry friction goes.

use super::super::Phase;

/// How one side of a plant moves while a flow lasts.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// Without dry friction.
    Free,
    /// Held by it.
    Held,
    /// Against it, in a direction of ±1; 0 on bristles.
    Sliding(f64),
}

impl Side {
    #[inline]
    pub(super) fn of(dry: bool, velocity: f64, phase: Phase) -> Self {
        if !dry {
            Self::Free
        } else if velocity == 0.0 {
            Self::Held
        } else {
            Self::Sliding(phase.direction())
        }
    }

    #[inline]
    pub(super) fn direction(self) -> f64 {
        match self {
            Self::Sliding(direction) => direction,
            Self::Free | Self::Held => 0.0,
        }
    }

    /// True if it can have this velocity.
    #[inline]
    pub(super) fn has(self, velocity: f64) -> bool {
        match self {
            Self::Free | Self::Held => true,
            Self::Sliding(direction) => direction * velocity > 0.0,
        }
    }

    /// True if it may have stopped between two velocities, a step apart, that it can have.
    #[inline]
    pub(super) fn may_have_stopped(self, from: f64, to: f64) -> bool {
        self.direction() != 0.0 && to.abs() < (to - from).abs()
    }
}
