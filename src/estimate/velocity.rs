//! Velocity by a tracking observer that knows the torque.

use core::f32::consts::TAU;

/// Gains of the observer for one tick.
#[derive(Clone, Copy, Debug)]
pub struct TrackerGains {
    tick_s: f32,
    position: f32,
    velocity_per_s: f32,
}

impl TrackerGains {
    /// Both poles at `bandwidth_hz`: critically damped.
    ///
    /// With p = exp(-2 pi f T): alpha = 1 - p^2, beta = (1 - p)^2
    /// (Brookner, Tracking and Kalman Filtering Made Easy, section 1.2.6: the fading-memory g-h filter).
    pub fn new(bandwidth_hz: f32, tick_s: f32) -> Self {
        let pole = libm::expf(-TAU * bandwidth_hz * tick_s);
        Self {
            tick_s,
            position: 1.0 - pole * pole,
            velocity_per_s: (1.0 - pole) * (1.0 - pole) / tick_s,
        }
    }
}

/// Alpha-beta filter with a known input: the torque moves a model of the paddle, each sample corrects it.
///
/// It is the steady-state Kalman filter of an inertia that is driven by a known torque and white acceleration, and
/// read with white noise. Two things make it better than a filtered difference: the lag is only that of what the
/// torque does not explain (friction), and the noise of the samples falls off with the second order instead of
/// passing at full gain up to half the rate. The quantum of the encoder, whose derivative is a train of pulses and
/// no white noise, gains from the first only.
#[derive(Clone, Copy, Debug)]
pub struct VelocityTracker {
    gains: TrackerGains,
    position_rad: f32,
    velocity_rad_s: f32,
}

impl VelocityTracker {
    /// An observer at rest at 0.
    pub fn new(gains: TrackerGains) -> Self {
        Self {
            gains,
            position_rad: 0.0,
            velocity_rad_s: 0.0,
        }
    }

    /// Takes over gains; the estimate stays.
    pub fn retune(&mut self, gains: TrackerGains) {
        self.gains = gains;
    }

    /// At rest at `position_rad`.
    pub fn reset(&mut self, position_rad: f32) {
        self.position_rad = position_rad;
        self.velocity_rad_s = 0.0;
    }

    /// Takes a measured position, rad, and the acceleration since the sample before that the torque should have
    /// made, rad/s^2; gives the velocity, rad/s.
    #[inline]
    pub fn update(&mut self, measured_rad: f32, acceleration_rad_s2: f32) -> f32 {
        let predicted = self.position_rad + self.velocity_rad_s * self.gains.tick_s;
        self.velocity_rad_s += acceleration_rad_s2 * self.gains.tick_s;
        let innovation = measured_rad - predicted;
        self.position_rad = predicted + self.gains.position * innovation;
        self.velocity_rad_s += self.gains.velocity_per_s * innovation;
        self.velocity_rad_s
    }

    /// The last estimate, rad/s.
    #[inline]
    pub fn velocity_rad_s(&self) -> f32 {
        self.velocity_rad_s
    }
}
