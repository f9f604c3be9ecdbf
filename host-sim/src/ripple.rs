//! What comes and goes with the turns of something that is not round.

/// `r sin(n x) + s (cos(n x) − 1)`: nothing at position zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// r.
    pub sine: f64,
    /// s, in units of r.
    pub cosine: f64,
    /// n, 1/position.
    pub wave_number: f64,
}

impl Ripple {
    /// No ripple.
    pub const NONE: Self = Self {
        sine: 0.0,
        cosine: 0.0,
        wave_number: 0.0,
    };

    /// True if it is zero everywhere.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.sine == 0.0 && self.cosine == 0.0
    }

    /// Its value at a position, in units of r.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        let (sin, cos) = (self.wave_number * x).sin_cos();
        self.sine * sin + self.cosine * (cos - 1.0)
    }

    /// Its slope there.
    #[inline]
    pub fn slope(&self, x: f64) -> f64 {
        let (sin, cos) = (self.wave_number * x).sin_cos();
        self.wave_number * (self.sine * cos - self.cosine * sin)
    }
}
