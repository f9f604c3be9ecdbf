//! Draws devices of four families at random scales.

use std::f64::consts::TAU;

use recording::{Model, Sensor, Units};

use crate::draw::Draw;

/// The family of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Paddle,
    Servo,
    Linear,
    DirectDrive,
}

/// A device, its sampling, and a motion that suits it.
#[derive(Clone, Debug)]
pub(crate) struct Plant {
    pub family: Family,
    /// The true numbers, before effects are hidden.
    pub model: Model,
    pub units: Units,
    /// Half the span of a typical motion, in units of position.
    pub amplitude: f64,
    /// Frequency of a typical motion.
    pub motion_hz: f64,
    /// Period of the control loop, s.
    pub tick_s: f64,
    /// Number of control ticks per logged row.
    pub ticks_per_row: usize,
    pub sensor: Sensor,
    pub horizon_s: f64,
}

/// Probability that the log of a device is low-passed.
const LOW_PASSED: f64 = 0.25;
/// Least and largest corner frequency of that low-pass over the rate of the control loop.
const CORNERS: [f64; 2] = [0.15, 0.7];
/// Least corner frequency over the frequency of the motion.
const LEAST_CORNER: f64 = 15.0;

/// Fewest rows in a horizon after the sampling rate is changed.
const LEAST_HORIZON_ROWS: f64 = 12.0;

/// Probability that the torque of a device has a known lag.
const LAGGING: f64 = 0.25;
/// Least and largest known lag over the time constant of the motion.
const KNOWN_LAGS: [f64; 2] = [0.005, 0.05];

impl Plant {
    /// Draws a device on which the effects `names` can be identified in principle.
    pub fn draw(draw: &mut Draw, names: &[&str]) -> Self {
        let [hangs, springs, scales] =
            ["gravity", "spring", "sensor_gain"].map(|name| names.contains(&name));
        // Gravity and a spring differ at large angles only.
        let family = if hangs {
            draw.pick(&[Family::Servo, Family::DirectDrive])
        } else if springs {
            draw.pick(&[Family::Servo, Family::DirectDrive, Family::Linear])
        } else {
            draw.pick(&[
                Family::Paddle,
                Family::Paddle,
                Family::Servo,
                Family::Linear,
                Family::DirectDrive,
            ])
        };
        let mut plant = match family {
            Family::Paddle => paddle(draw),
            Family::Servo => servo(draw),
            Family::Linear => linear(draw),
            Family::DirectDrive => direct_drive(draw),
        };
        if (hangs || springs) && family != Family::Linear {
            plant.amplitude = draw.uniform(1.1, 1.8);
        }
        if scales && family != Family::Servo && family != Family::Paddle {
            // Without a restoring torque, a sensor gain cannot be told from a wrong inertia.
            plant.model.stiffness = draw.uniform(0.3, 1.0) * plant.torque() / plant.amplitude;
        }
        if plant.ticks_per_row == 1 && draw.chance(LOW_PASSED) {
            let corner = draw.log_uniform(CORNERS[0], CORNERS[1]) / (TAU * plant.tick_s);
            plant.sensor.cutoff_hz = Some(corner.max(LEAST_CORNER * plant.motion_hz).round());
        }
        if draw.chance(LAGGING) {
            let share = draw.log_uniform(KNOWN_LAGS[0], KNOWN_LAGS[1]);
            plant.model.lag = share / (TAU * plant.motion_hz);
        }
        plant
    }

    /// Changes the sampling rate to `rows_hz` with `ticks_per_row` control ticks per row. The horizon then holds enough
    /// rows.
    pub fn resample(&mut self, rows_hz: f64, ticks_per_row: usize) {
        let tick_s = 1.0 / (rows_hz * ticks_per_row as f64);
        // The corner of the log's low-pass scales with the rate of the control loop. A decimated log has no low-pass.
        self.sensor.cutoff_hz = self
            .sensor
            .cutoff_hz
            .filter(|_| ticks_per_row == 1)
            .map(|hz| {
                let corner_hz = hz * self.tick_s / tick_s;
                corner_hz.max(LEAST_CORNER * self.motion_hz).round()
            });
        self.tick_s = (tick_s * 1e7).round() / 1e7;
        self.ticks_per_row = ticks_per_row;
        self.horizon_s = self.horizon_s.max(LEAST_HORIZON_ROWS / rows_hz);
        self.horizon_s = (self.horizon_s * 100.0).ceil() / 100.0;
    }

    /// Torque of the typical motion, N m.
    pub fn torque(&self) -> f64 {
        self.model.inertia * self.amplitude * (TAU * self.motion_hz).powi(2)
    }
}

fn horizon(draw: &mut Draw, motion_hz: f64) -> f64 {
    let horizon = (draw.log_uniform(0.12, 0.5) / motion_hz).clamp(0.1, 0.8);
    (horizon * 100.0).round() / 100.0
}

fn units(position: &str, input: &str) -> Units {
    Units {
        position: position.into(),
        input: input.into(),
    }
}

fn paddle(draw: &mut Draw) -> Plant {
    let model = Model {
        viscous: draw.log_uniform(1e-4, 2e-3),
        coulomb: draw.log_uniform(0.003, 0.015),
        gravity: draw.log_uniform(0.01, 0.025),
        ratio: draw.pick(&[15.0, 15.0, 12.0, 20.0]),
        travel: Some([-0.61, 0.61]),
        ..Model::new(draw.log_uniform(3.5e-4, 9e-4))
    };
    let motion_hz = draw.log_uniform(0.8, 3.0);
    let (tick_s, ticks_per_row) =
        draw.pick(&[(3.5e-4, 1), (3.5e-4, 3), (1e-3, 1), (5e-4, 2), (3.3e-4, 1)]);
    let sensor = if draw.chance(0.6) {
        Sensor {
            resolution: 2.09e-4,
            noise: draw.pick(&[0.0, 0.0, 5e-5]),
            cutoff_hz: None,
        }
    } else {
        Sensor {
            resolution: 0.0,
            noise: draw.log_uniform(5e-5, 4.5e-4),
            cutoff_hz: None,
        }
    };
    Plant {
        family: Family::Paddle,
        model,
        units: Units::default(),
        amplitude: draw.uniform(0.2, 0.5),
        motion_hz,
        tick_s,
        ticks_per_row,
        sensor,
        horizon_s: horizon(draw, motion_hz),
    }
}

fn servo(draw: &mut Draw) -> Plant {
    let mut model = Model {
        viscous: draw.log_uniform(0.005, 0.05),
        coulomb: draw.log_uniform(0.01, 0.06),
        gravity: draw.log_uniform(0.15, 0.8),
        gravity_zero: draw.uniform(-0.03, 0.03),
        ratio: draw.log_uniform(0.3, 1.5),
        ..Model::new(draw.log_uniform(0.004, 0.02))
    };
    if draw.chance(0.3) {
        model.delay = (draw.log_uniform(0.002, 0.01) * 1e4).round() / 1e4;
    }
    let motion_hz = draw.log_uniform(0.35, 1.2);
    Plant {
        family: Family::Servo,
        model,
        units: units("rad", draw.pick(&["duty", "A"])),
        amplitude: draw.uniform(0.5, 1.5),
        motion_hz,
        tick_s: draw.pick(&[5e-3, 5.26e-3, 4e-3]),
        ticks_per_row: 1,
        sensor: Sensor {
            resolution: draw.pick(&[1.534e-3, 3.83e-4]),
            noise: 0.0,
            cutoff_hz: None,
        },
        horizon_s: horizon(draw, motion_hz),
    }
}

/// Sets friction and drag as shares of the torque of the motion.
fn load_with_friction(plant: &mut Plant, draw: &mut Draw) {
    let torque = plant.torque();
    let speed = plant.amplitude * TAU * plant.motion_hz;
    plant.model.coulomb = torque * draw.log_uniform(0.08, 0.5);
    plant.model.viscous = torque / speed * draw.log_uniform(0.03, 0.4);
}

fn linear(draw: &mut Draw) -> Plant {
    let amplitude = draw.log_uniform(0.01, 0.2);
    let motion_hz = draw.log_uniform(0.6, 3.0);
    let noise = amplitude * draw.log_uniform(3e-5, 3e-4);
    let (tick_s, ticks_per_row) = draw.pick(&[(1e-3, 1), (5e-4, 1), (2e-3, 1), (5e-4, 2)]);
    let mut plant = Plant {
        family: Family::Linear,
        model: Model {
            ratio: draw.log_uniform(2.0, 30.0),
            ..Model::new(draw.log_uniform(0.2, 5.0))
        },
        units: units("m", draw.pick(&["A", "N", "V"])),
        amplitude,
        motion_hz,
        tick_s,
        ticks_per_row,
        sensor: coarse_or_noisy(draw, noise),
        horizon_s: horizon(draw, motion_hz),
    };
    load_with_friction(&mut plant, draw);
    if draw.chance(0.3) {
        plant.model.stiffness = draw.uniform(0.2, 1.0) * plant.torque() / amplitude;
    }
    if draw.chance(0.4) {
        let reach = amplitude * draw.uniform(1.5, 2.5);
        plant.model.travel = Some([-reach, reach]);
        plant.model.stop_stiffness = plant.torque() / (amplitude * draw.log_uniform(0.005, 0.03));
        plant.model.stop_damping = 0.4 * (plant.model.stop_stiffness * plant.model.inertia).sqrt();
    }
    plant
}

/// Draws a sensor that is quantised and quiet, or continuous and noisy, with about the same error.
fn coarse_or_noisy(draw: &mut Draw, noise: f64) -> Sensor {
    let coarse = draw.chance(0.5);
    Sensor {
        resolution: if coarse { 2.0 * noise } else { 0.0 },
        noise: if coarse { 0.0 } else { noise },
        cutoff_hz: None,
    }
}

fn direct_drive(draw: &mut Draw) -> Plant {
    let motion_hz = draw.log_uniform(0.6, 3.0);
    let noise = draw.log_uniform(8e-5, 6e-4);
    let (tick_s, ticks_per_row) = draw.pick(&[(1e-3, 1), (2e-3, 1), (5e-4, 1), (1e-3, 2)]);
    let mut plant = Plant {
        family: Family::DirectDrive,
        model: Model {
            ratio: draw.pick(&[1.0, 1.0, 0.05, 0.6]),
            ..Model::new(draw.log_uniform(2e-4, 5e-3))
        },
        units: units("rad", draw.pick(&["N m", "A"])),
        amplitude: draw.uniform(0.5, 2.0),
        motion_hz,
        tick_s,
        ticks_per_row,
        sensor: coarse_or_noisy(draw, noise),
        horizon_s: horizon(draw, motion_hz),
    };
    load_with_friction(&mut plant, draw);
    if draw.chance(0.5) {
        plant.model.gravity = draw.uniform(0.3, 1.0) * plant.torque();
    }
    plant
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_with_gravity_is_rotary_in_any_order_of_effects() {
        for index in 0..40 {
            for names in [["gravity", "deadband"], ["deadband", "gravity"]] {
                let plant = Plant::draw(&mut Draw::of_case(1, index), &names);
                assert!(plant.family != Family::Linear, "{names:?}");
            }
        }
    }
}
