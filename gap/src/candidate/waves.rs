//! Sine waves over position, of one wave number after the other.

/// Sines and cosines at some positions, of a wave number that grows step by step: angles are turned on, which takes no sine.
pub(super) struct Waves {
    /// By position: sine and cosine.
    now: Vec<[f64; 2]>,
    step: Vec<[f64; 2]>,
}

impl Waves {
    /// Of the wave number `first` at some positions.
    pub(super) fn of(positions: &[f64], first: f64, step: f64) -> Self {
        let waves = |n: f64| {
            let waves = positions.iter().map(|x| (n * x).sin_cos().into());
            waves.collect()
        };
        Self {
            now: waves(first),
            step: waves(step),
        }
    }

    /// By position: sine and cosine.
    pub(super) fn now(&self) -> &[[f64; 2]] {
        &self.now
    }

    /// Goes on to the next wave number.
    pub(super) fn go_on(&mut self) {
        for ([sin, cos], [by_sin, by_cos]) in self.now.iter_mut().zip(&self.step) {
            (*sin, *cos) = (*sin * by_cos + *cos * by_sin, *cos * by_cos - *sin * by_sin);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_what_sines_are() {
        let positions = [-3.0, 0.0, 0.7, 250.0];
        let mut waves = Waves::of(&positions, 1.5, 0.25);
        for i in 0..1000 {
            let n = 1.5 + 0.25 * f64::from(i);
            for (x, [sin, cos]) in positions.iter().zip(waves.now()) {
                assert!((sin - (n * x).sin()).abs() < 1e-9);
                assert!((cos - (n * x).cos()).abs() < 1e-9);
            }
            waves.go_on();
        }
    }
}
