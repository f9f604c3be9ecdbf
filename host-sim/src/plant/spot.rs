//! A place at which something rubs.

/// `h exp(−(x − c)²/w²)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// h: relative to the level around it, negative where less rubs.
    pub height: f64,
    /// c, rad.
    pub position: f64,
    /// w, rad; positive.
    pub width: f64,
}

impl Spot {
    /// No such place.
    pub const NONE: Self = Self {
        height: 0.0,
        position: 0.0,
        width: 1.0,
    };

    /// True if it is zero everywhere.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.height == 0.0
    }

    /// Its value at a position.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.height * (-((x - self.position) / self.width).powi(2)).exp()
    }
}
