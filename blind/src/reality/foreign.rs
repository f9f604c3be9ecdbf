//! Causes outside the vocabulary. A diagnosis must not give them a name.

use std::f64::consts::TAU;

use super::Motion;

/// A time interval of the session.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub from_s: f64,
    pub to_s: f64,
}

impl Window {
    fn holds(self, time_s: f64) -> bool {
        (self.from_s..self.to_s).contains(&time_s)
    }
}

/// An external disturbance torque.
#[derive(Clone, Debug)]
pub(crate) enum Disturbance {
    /// Band-limited noise: linear interpolation of `values`, which are `every_s` seconds apart. It acts inside `windows`
    /// only.
    Noise {
        values: Vec<f64>,
        every_s: f64,
        windows: Vec<Window>,
    },
    /// A sine in time.
    Tone {
        amplitude: f64,
        hz: f64,
        phase_rad: f64,
    },
}

/// A spring with a relaxing anchor: torque `-stiffness * (x - anchor)`. The anchor follows the position with the time
/// constant `time_s`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Creep {
    pub stiffness: f64,
    pub time_s: f64,
}

/// All causes outside the vocabulary. By default none acts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foreign {
    pub disturbance: Option<Disturbance>,
    /// Inertia times `1 + amount * sin(2 pi hz t)`, as `(amount, hz)`.
    pub breathing_inertia: Option<(f64, f64)>,
    /// Torque gain times `1 + amount * sin(2 pi hz t)`, as `(amount, hz)`.
    pub swinging_gain: Option<(f64, f64)>,
    /// Intervals in which the actuator gives no torque.
    pub dropouts: Vec<Window>,
    /// Sinusoidal tilt of the base: amplitude in rad and frequency in Hz.
    pub rocking: Option<(f64, f64)>,
    pub creep: Option<Creep>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Memory {
    anchor: Option<f64>,
}

impl Foreign {
    /// The factor on the torque of the actuator.
    pub fn fade(&self, _memory: &mut Memory, time_s: f64, _dt: f64) -> f64 {
        if self.dropouts.iter().any(|window| window.holds(time_s)) {
            return 0.0;
        }
        self.swinging_gain
            .map_or(1.0, |(amount, hz)| 1.0 + amount * (TAU * hz * time_s).sin())
    }

    /// The disturbance torque and the torque of the creeping spring, N m.
    pub fn torque(&self, memory: &mut Memory, time_s: f64, motion: Motion, dt: f64) -> f64 {
        let mut torque = match &self.disturbance {
            None => 0.0,
            Some(Disturbance::Tone {
                amplitude,
                hz,
                phase_rad,
            }) => amplitude * (TAU * hz * time_s + phase_rad).sin(),
            Some(Disturbance::Noise {
                values,
                every_s,
                windows,
            }) => {
                let place = time_s / every_s;
                let k = place as usize;
                if windows.iter().any(|window| window.holds(time_s)) && k + 1 < values.len() {
                    let part = place - k as f64;
                    values[k] * (1.0 - part) + values[k + 1] * part
                } else {
                    0.0
                }
            }
        };
        if let Some(creep) = self.creep {
            let anchor = memory.anchor.get_or_insert(motion.x);
            torque -= creep.stiffness * (motion.x - *anchor);
            *anchor += (motion.x - *anchor) * dt / creep.time_s;
        }
        torque
    }

    /// The factor on the inertia.
    pub fn inertia_factor(&self, time_s: f64) -> f64 {
        self.breathing_inertia
            .map_or(1.0, |(amount, hz)| 1.0 + amount * (TAU * hz * time_s).sin())
    }

    /// The tilt of the base, rad.
    pub fn tilt(&self, time_s: f64) -> f64 {
        self.rocking
            .map_or(0.0, |(amplitude, hz)| amplitude * (TAU * hz * time_s).sin())
    }
}
