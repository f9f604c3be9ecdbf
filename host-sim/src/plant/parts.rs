//! The parts that a plant may have or not.

use super::{Barrier, Cogging, Link, Mechanics, Presliding};

/// The optional parts, where there are any. One that is absent is all zeros, and not a payload left as it happens to be,
/// of which compilers compute in advance what they may need: where that is subnormal, at a hundred times the cost.
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
