//! How dry friction acts on one side of a plant.

use super::super::Phase;

/// How dry friction acts on one side of a plant while a linear solution is valid.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// There is no dry friction.
    Free,
    /// Dry friction holds it at rest.
    Held,
    /// It slides, in a direction of ±1; 0 on bristles.
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

    /// True if this velocity is possible on it.
    #[inline]
    pub(super) fn has(self, velocity: f64) -> bool {
        match self {
            Self::Free | Self::Held => true,
            Self::Sliding(direction) => direction * velocity > 0.0,
        }
    }

    /// True if it may have stopped within a step between these two velocities.
    #[inline]
    pub(super) fn may_have_stopped(self, from: f64, to: f64) -> bool {
        self.direction() != 0.0 && to.abs() < (to - from).abs()
    }
}
