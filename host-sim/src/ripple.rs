//! A periodic ripple over the position, as of an eccentric pulley.

/// `r sin(n x) + s (cos(n x) − 1)`. It is zero at position zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// Amplitude r.
    pub sine: f64,
    /// s, relative to r.
    pub cosine: f64,
    /// Wave number n, 1/position.
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

    /// Its slope at a position.
    #[inline]
    pub fn slope(&self, x: f64) -> f64 {
        let (sin, cos) = (self.wave_number * x).sin_cos();
        self.wave_number * (self.sine * cos - self.cosine * sin)
    }
}
