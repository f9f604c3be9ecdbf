//! Dry friction that is higher or lower around one position.

/// `h exp(−|(x − c)/w|ᵐ)`: a bell with m of 2, a band with more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// h: height relative to the level around it, negative where friction is lower.
    pub height: f64,
    /// c: position of the middle, rad.
    pub position: f64,
    /// w: half of the width, rad; positive.
    pub width: f64,
    /// m: steepness of the flanks, 2 or more.
    pub exponent: f64,
}

impl Spot {
    /// No spot.
    pub const NONE: Self = Self {
        height: 0.0,
        position: 0.0,
        width: 1.0,
        exponent: Self::BELL,
    };

    /// Exponent of a bell.
    pub const BELL: f64 = 2.0;

    /// True if it is zero everywhere.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.height == 0.0
    }

    /// Its value at a position.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        let beside = (x - self.position) / self.width;
        let power = match self.exponent {
            Self::BELL => beside.powi(2),
            exponent => beside.abs().powf(exponent),
        };
        self.height * (-power).exp()
    }
}
