//! The parts that a plant may have or not.

use super::{Barrier, Cogging, Link, Mechanics, Presliding};

/// The optional parts of a plant. An absent part is all zeros: compilers compute with it in advance, and arithmetic
/// with leftover subnormal numbers takes a hundred times as long.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub has_link: bool,
    pub link: Link,
    pub has_bristles: bool,
    pub bristles: Presliding,
    pub has_cogging: bool,
    pub cogging: Cogging,
    pub barriers: Vec<Barrier>,
}

impl Parts {
    pub(super) fn of(mechanics: &Mechanics) -> Self {
        let Mechanics {
            link,
            presliding,
            cogging,
            barriers,
            ..
        } = mechanics;
        Self {
            has_link: link.is_some(),
            link: link.unwrap_or(Link::NONE),
            has_bristles: presliding.is_some(),
            bristles: presliding.unwrap_or(Presliding::NONE),
            has_cogging: cogging.is_some(),
            cogging: cogging.unwrap_or(Cogging::NONE),
            barriers: barriers.iter().flatten().copied().collect(),
        }
    }
}
