//! Metrics of a step response as the lab report defines them, computed sample by sample in constant memory.

use crate::estimate::low_pass::{self, LowPass};

/// Time constant of the weighted mean that gives the steady-state error, s.
const STEADY_STATE_S: f32 = 0.02;

/// Computes the metrics of a step response sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct StepMetrics {
    tick_s: f32,
    band_rad: f32,
    target_rad: f32,
    direction: f32,
    tick: u32,
    rise_tick: Option<u32>,
    last_outside_tick: Option<u32>,
    inside: bool,
    overshoot_rad: f32,
    error_rad: LowPass,
}

/// The metrics of a step response so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Largest excess of the position over the target, rad. 0 without overshoot.
    pub overshoot_rad: f32,
    /// Time from the step to the first crossing of the target, s. `None` if it was never reached.
    pub rise_s: Option<f32>,
    /// Time from the step to the last sample outside the band, s. 0 if no sample was outside. `None` if the last sample is
    /// outside.
    pub settling_s: Option<f32>,
    /// Target minus position, rad: a mean with exponential weights of 20 ms, in which the latest sample weighs most.
    pub steady_state_error_rad: f32,
    /// Time since the step, s.
    pub elapsed_s: f32,
}

impl StepMetrics {
    /// Starts at the step from `from_rad` to `target_rad`. The next sample is the one at time 0.
    ///
    /// The response counts as settled within `band_rad` of the target. Samples come every `tick_s`.
    pub fn start(from_rad: f32, target_rad: f32, band_rad: f32, tick_s: f32) -> Self {
        let mut error_rad = LowPass::new(low_pass::gain(
            1.0 / (core::f32::consts::TAU * STEADY_STATE_S),
            tick_s,
        ));
        error_rad.reset(target_rad - from_rad);
        Self {
            tick_s,
            band_rad,
            target_rad,
            direction: if target_rad < from_rad { -1.0 } else { 1.0 },
            tick: 0,
            rise_tick: None,
            last_outside_tick: None,
            inside: false,
            overshoot_rad: 0.0,
            error_rad,
        }
    }

    /// Processes the next sample, rad.
    #[inline]
    pub fn update(&mut self, position_rad: f32) {
        let beyond_rad = self.direction * (position_rad - self.target_rad);
        if beyond_rad >= 0.0 && self.rise_tick.is_none() {
            self.rise_tick = Some(self.tick);
        }
        if beyond_rad > self.overshoot_rad {
            self.overshoot_rad = beyond_rad;
        }
        self.inside = beyond_rad.abs() <= self.band_rad;
        if !self.inside {
            self.last_outside_tick = Some(self.tick);
        }
        self.error_rad.update(self.target_rad - position_rad);
        self.tick = self.tick.saturating_add(1);
    }

    /// The metrics so far.
    pub fn report(&self) -> StepReport {
        let seconds = |tick: u32| tick as f32 * self.tick_s;
        StepReport {
            overshoot_rad: self.overshoot_rad,
            rise_s: self.rise_tick.map(seconds),
            settling_s: self
                .inside
                .then(|| self.last_outside_tick.map_or(0.0, seconds)),
            steady_state_error_rad: self.error_rad.output(),
            elapsed_s: seconds(self.tick),
        }
    }
}
