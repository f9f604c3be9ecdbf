//! Velocity by a tracking observer.

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

/// Alpha-beta filter: a model of constant velocity, corrected by each sample.
///
/// It is the steady-state Kalman filter of a position that is driven by white acceleration and read with white
/// noise. A filtered difference lets the quantum of the encoder through at full gain up to half the sampling
/// rate; the observer rolls it off with the second order, so that for the same lag it is several times quieter.
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

    /// Takes a measured position, rad, and gives the velocity, rad/s.
    #[inline]
    pub fn update(&mut self, measured_rad: f32) -> f32 {
        let predicted = self.position_rad + self.velocity_rad_s * self.gains.tick_s;
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
