//! The elastic part of dry friction.

/// Bristles that bend before they slide, in place of stick: the LuGre model of Canudas de Wit,
/// Olsson, Åström and Lischinsky (IEEE TAC 40, 1995),
///
/// `z' = v − |v| z / z_s`, `F = (z / z_s) F_sliding + σ₁ z'`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presliding {
    /// Deflection `z_s` at which the bristles slide, rad.
    pub distance: f64,
    /// Damping σ₁ of the bristles, N m s/rad.
    pub damping: f64,
}

/// Share of its sliding deflection at which a bristle counts as sliding.
const SLID: f64 = 0.98;

impl Presliding {
    /// Rate of the deflection, rad/s.
    #[inline]
    pub(super) fn rate(&self, velocity: f64, deflection: f64) -> f64 {
        velocity - velocity.abs() * deflection / self.distance
    }

    /// True where the deflection has settled and would relax faster than a step of `step_s` follows.
    #[inline]
    pub(super) fn has_slid(&self, velocity: f64, deflection: f64, step_s: f64) -> bool {
        deflection * velocity.signum() > SLID * self.distance
            && velocity.abs() * step_s > self.distance
    }

    /// Fastest rate of an inertia on bristles of this sliding level, 1/s.
    pub(super) fn fastest_rate(&self, inertia: f64, level_nm: f64) -> f64 {
        (level_nm / self.distance / inertia).sqrt() + self.damping / inertia
    }
}
