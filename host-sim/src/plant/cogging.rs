//! Torque ripple over position.

/// `A sin θ + a sin 2θ + b cos 2θ` with `θ = n x + φ`, and further waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cogging {
    /// The first wave: A, n and φ.
    pub first: Wave,
    /// a and b, N m.
    pub second_nm: [f64; 2],
    /// Waves of other orders; unused places have the amplitude 0.
    pub further: [Wave; FURTHER],
}

/// Most waves beside the first.
pub const FURTHER: usize = 3;

/// `A sin(n x + φ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// A, N m.
    pub amplitude_nm: f64,
    /// n: 2π over the period, 1/rad.
    pub wave_number: f64,
    /// φ, rad.
    pub phase: f64,
}

impl Wave {
    /// No ripple.
    pub const NONE: Self = Self {
        amplitude_nm: 0.0,
        wave_number: 0.0,
        phase: 0.0,
    };

    /// Largest slope, N m/rad.
    fn stiffness(&self) -> f64 {
        (self.amplitude_nm * self.wave_number).abs()
    }
}

impl Cogging {
    /// No ripple.
    pub(super) const NONE: Self = Self {
        first: Wave::NONE,
        second_nm: [0.0; 2],
        further: [Wave::NONE; FURTHER],
    };

    /// Torque at a position, N m.
    #[inline]
    pub fn torque(&self, position: f64) -> f64 {
        let (sin, cos) = (self.first.wave_number * position + self.first.phase).sin_cos();
        let [a, b] = self.second_nm;
        let first = self.first.amplitude_nm * sin;
        let mut torque = first + 2.0 * a * sin * cos + b * (1.0 - 2.0 * sin * sin);
        for wave in self
            .further
            .iter()
            .take_while(|wave| wave.amplitude_nm != 0.0)
        {
            torque += wave.amplitude_nm * (wave.wave_number * position + wave.phase).sin();
        }
        torque
    }

    /// Largest slope, N m/rad.
    pub(super) fn stiffness(&self) -> f64 {
        let [a, b] = self.second_nm;
        let second = 2.0 * a.hypot(b) * self.first.wave_number.abs();
        let further = self.further.iter().map(Wave::stiffness);
        self.first.stiffness() + second + further.sum::<f64>()
    }
}
