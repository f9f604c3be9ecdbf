//! Torque ripple over position.

/// `A sin θ + a sin 2θ + b cos 2θ` with `θ = n x + φ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cogging {
    /// A, N m.
    pub amplitude_nm: f64,
    /// n: 2π over the period, 1/rad.
    pub wave_number: f64,
    /// φ, rad.
    pub phase: f64,
    /// a and b, N m.
    pub second_nm: [f64; 2],
}

impl Cogging {
    /// None at all.
    pub(super) const NONE: Self = Self {
        amplitude_nm: 0.0,
        wave_number: 0.0,
        phase: 0.0,
        second_nm: [0.0; 2],
    };

    /// N m at a position.
    #[inline]
    pub fn torque(&self, position: f64) -> f64 {
        let (sin, cos) = (self.wave_number * position + self.phase).sin_cos();
        let [a, b] = self.second_nm;
        self.amplitude_nm * sin + 2.0 * a * sin * cos + b * (1.0 - 2.0 * sin * sin)
    }

    /// Largest slope, N m/rad.
    pub(super) fn stiffness(&self) -> f64 {
        let [a, b] = self.second_nm;
        (self.amplitude_nm.abs() + 2.0 * a.hypot(b)) * self.wave_number.abs()
    }
}
