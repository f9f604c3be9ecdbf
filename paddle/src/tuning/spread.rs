//! Paddles that differ from the known paddle.

use host_sim::device::Device;

/// Factors on the least known parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Factor on dry and viscous friction.
    pub friction: f64,
    /// Factor on the inertia.
    pub inertia: f64,
}

impl Variant {
    /// The known paddle, then the corners of the parameter range. Both arguments are relative: 0.3 means ± 30 %.
    pub fn of(friction: f64, inertia: f64) -> Vec<Self> {
        let mut all = vec![Self {
            friction: 1.0,
            inertia: 1.0,
        }];
        for (f, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let corner = Self {
                friction: 1.0 + f * friction,
                inertia: 1.0 + j * inertia,
            };
            if !all.contains(&corner) {
                all.push(corner);
            }
        }
        all
    }

    /// Applies the factors to `device`.
    pub fn apply(&self, device: &mut Device) {
        let mechanics = &mut device.mechanics;
        mechanics.inertia *= self.inertia;
        mechanics.viscous *= self.friction;
        for level_nm in &mut mechanics.friction.level_nm {
            *level_nm *= self.friction;
        }
        mechanics.friction.load_share *= self.friction;
        mechanics.friction.load_backdriven_extra *= self.friction;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_of_one_quantity_has_no_paddle_twice() {
        assert_eq!(Variant::of(0.3, 0.1).len(), 5);
        assert_eq!(Variant::of(0.3, 0.0).len(), 3);
        assert_eq!(Variant::of(0.0, 0.0).len(), 1);
    }
}
