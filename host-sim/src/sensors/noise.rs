//! Seeded noise.

use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// White Gaussian noise. It is identical for the same seed on every machine.
#[derive(Clone, Debug)]
pub struct Noise(Xoshiro256PlusPlus);

impl Noise {
    /// Noise from this seed.
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next value, with this standard deviation. For 0 no random number is drawn.
    #[inline]
    pub fn next(&mut self, standard_deviation: f64) -> f64 {
        if standard_deviation == 0.0 {
            return 0.0;
        }
        let unit: f64 = StandardNormal.sample(&mut self.0);
        standard_deviation * unit
    }
}
