//! Seeded random draws.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;

/// A random stream that depends on its seed only.
pub struct Draw(Xoshiro256PlusPlus);

impl Draw {
    /// The stream of case `index` of the set `seed`. Streams of neighbouring cases are independent.
    pub fn of_case(seed: u64, index: u64) -> Self {
        let mut mixer = Xoshiro256PlusPlus::seed_from_u64(seed);
        let key: u64 = mixer.random();
        Self(Xoshiro256PlusPlus::seed_from_u64(
            key.wrapping_add(index.wrapping_mul(0x9E37_79B9_7F4A_7C15)),
        ))
    }

    /// Splits off an independent stream.
    pub fn split(&mut self) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(self.seed()))
    }

    /// Draws a seed for another generator.
    pub fn seed(&mut self) -> u64 {
        self.0.random()
    }

    /// The stream with this seed.
    pub fn seeded(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Draws from the uniform distribution between `low` and `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Draws from the log-uniform distribution between two positive numbers.
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    /// Draws from the normal distribution with zero mean and unit variance.
    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    /// Draws from the normal distribution, truncated at ± `limit` standard deviations.
    pub fn normal_within(&mut self, limit: f64) -> f64 {
        loop {
            let value = self.normal();
            if value.abs() <= limit {
                return value;
            }
        }
    }

    /// Returns true with `probability`.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// Draws +1 or -1 with equal probability.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// Draws an integer from `low` to `high`, both included.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        self.0.random_range(low..=high)
    }

    /// Draws one of `choices`, which must not be empty.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.random_range(0..choices.len())]
    }
}
