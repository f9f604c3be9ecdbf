//! Velocity observer with known motor torque and estimated disturbance torque.

use core::f32::consts::TAU;

use crate::scalar::flushed;

/// Gains of the observer per tick.
#[derive(Clone, Copy, Debug)]
pub struct ObserverGains {
    tick_s: f32,
    position: f32,
    velocity_per_s: f32,
    acceleration_per_s2: f32,
}

impl ObserverGains {
    /// Places all three poles at `bandwidth_hz`, which is critically damped.
    ///
    /// With p = exp(-2 pi f T): g = 1 - p^3, h = 1.5 (1 - p)^2 (1 + p), k = (1 - p)^3 / 2 (Brookner, Tracking and Kalman
    /// Filtering Made Easy, section 1.3: the fading-memory g-h-k filter).
    pub fn new(bandwidth_hz: f32, tick_s: f32) -> Self {
        let pole = libm::expf(-TAU * bandwidth_hz * tick_s);
        let open = 1.0 - pole;
        Self {
            tick_s,
            position: 1.0 - pole * pole * pole,
            velocity_per_s: 1.5 * open * open * (1.0 + pole) / tick_s,
            acceleration_per_s2: open * open * open / (tick_s * tick_s),
        }
    }
}

/// Extended-state observer: a g-h-k filter with a known input.
///
/// It is the steady-state Kalman filter of an inertia that is driven by a known torque and by an unknown, slowly varying
/// torque, and measured with white noise. It has three advantages over a filtered difference. It follows the motor torque
/// without lag. Disturbances by a hand, gravity or friction cause no steady-state error, because the third state estimates
/// them. The measurement noise is attenuated with second order instead of passing at full gain up to half the sampling rate.
#[derive(Clone, Copy, Debug)]
pub struct VelocityObserver {
    gains: ObserverGains,
    position_rad: f32,
    velocity_rad_s: f32,
    disturbance_rad_s2: f32,
}

impl VelocityObserver {
    /// An observer at rest at 0.
    pub fn new(gains: ObserverGains) -> Self {
        Self {
            gains,
            position_rad: 0.0,
            velocity_rad_s: 0.0,
            disturbance_rad_s2: 0.0,
        }
    }

    /// Changes the gains. The estimate is kept.
    pub fn retune(&mut self, gains: ObserverGains) {
        self.gains = gains;
    }

    /// Sets the observer to rest at `position_rad`.
    pub fn reset(&mut self, position_rad: f32) {
        *self = Self::new(self.gains);
        self.position_rad = position_rad;
    }

    /// Updates the observer with a measured position, rad, and the acceleration since the previous sample that results from
    /// the motor torque, rad/s^2. Returns the velocity, rad/s.
    #[inline]
    pub fn update(&mut self, measured_rad: f32, acceleration_rad_s2: f32) -> f32 {
        let gained_rad_s = (acceleration_rad_s2 + self.disturbance_rad_s2) * self.gains.tick_s;
        let predicted_rad =
            self.position_rad + (self.velocity_rad_s + 0.5 * gained_rad_s) * self.gains.tick_s;
        // All states decay with the innovation, so flushing it is enough.
        let innovation_rad = flushed(measured_rad - predicted_rad);
        let gains = &self.gains;
        self.position_rad = predicted_rad + gains.position * innovation_rad;
        self.velocity_rad_s += gained_rad_s + gains.velocity_per_s * innovation_rad;
        self.disturbance_rad_s2 += gains.acceleration_per_s2 * innovation_rad;
        self.velocity_rad_s
    }

    /// The last estimate, rad/s.
    #[inline]
    pub fn velocity_rad_s(&self) -> f32 {
        self.velocity_rad_s
    }
}
