//! Paddles that differ from the one that is known.

use host_sim::device::Device;

/// Factors on what is known least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// On dry and viscous friction.
    pub friction: f64,
    /// On the inertia.
    pub inertia: f64,
}

impl Variant {
    /// The known paddle, then the corners of the spread; each is relative, 0.3 = 30 % either way.
    pub fn of(friction: f64, inertia: f64) -> Vec<Self> {
        let mut all = vec![Self {
            friction: 1.0,
            inertia: 1.0,
        }];
        for (f, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            all.push(Self {
                friction: 1.0 + f * friction,
                inertia: 1.0 + j * inertia,
            });
        }
        all.dedup();
        all
    }

    /// Makes `device` this one.
    pub fn apply(&self, device: &mut Device) {
        let mechanics = &mut device.mechanics;
        mechanics.inertia *= self.inertia;
        mechanics.viscous *= self.friction;
        for level_nm in &mut mechanics.friction.level_nm {
            *level_nm *= self.friction;
        }
        mechanics.friction.load_share *= self.friction;
    }
}
