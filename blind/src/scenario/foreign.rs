//! Causes that are not in the vocabulary.

use std::f64::consts::TAU;

use super::{Plant, Scale};
use crate::draw::Draw;
use crate::reality::{Creep, Disturbance, Reality, Window};
use crate::truth::Place;

/// Names of these causes. Only the truth's file has them.
const NAMES: [&str; 9] = [
    "torque_noise",
    "torque_bursts",
    "torque_tone",
    "breathing_inertia",
    "swinging_gain",
    "power_dropouts",
    "rocking_base",
    "creeping_spring",
    "sensor_hum",
];

/// Time after the end of a disturbance during which the motion still shows it, s.
const AFTERMATH_S: f64 = 0.3;

/// One such cause with its strength.
#[derive(Clone, Debug)]
pub(crate) struct Cause {
    pub name: &'static str,
    pub strength: f64,
    pub range: [f64; 2],
    form: [f64; 3],
    seed: u64,
}

impl Cause {
    /// Draws a cause that has an effect on `plant`.
    pub fn draw(draw: &mut Draw, plant: &Plant) -> Self {
        let name = match draw.pick(&NAMES) {
            // A tilting base has no effect on an axis without gravity.
            "rocking_base" if plant.model.gravity == 0.0 => "creeping_spring",
            name => name,
        };
        let range = match name {
            "power_dropouts" => [0.02, 0.3],
            "sensor_hum" => [0.002, 0.1],
            _ => [0.03, 0.9],
        };
        Self {
            name,
            strength: draw.log_uniform(range[0], range[1]),
            range,
            form: std::array::from_fn(|_| draw.uniform(0.0, 1.0)),
            seed: draw.seed(),
        }
    }

    /// A frequency outside the motion's own frequencies.
    fn odd_hz(&self, scale: &Scale) -> f64 {
        scale.hz * (2.3 + 5.1 * self.form[0])
    }

    /// Intervals in which it acts, each with the index of its run.
    fn bursts(&self, scale: &Scale, share: f64) -> Vec<(usize, Window)> {
        let mut draw = Draw::seeded(self.seed);
        let mut windows = Vec::new();
        for (run, [from, to]) in scale.runs_s.iter().enumerate() {
            let mut at = from + draw.uniform(0.1, 1.5);
            while at < *to {
                let length = draw.uniform(0.1, 0.5) * share.max(0.1) * 2.0;
                windows.push((
                    run,
                    Window {
                        from_s: at,
                        to_s: at + length,
                    },
                ));
                at += length + draw.uniform(0.5, 3.0);
            }
        }
        windows
    }

    /// Adds the cause to `reality`.
    pub fn apply(&self, reality: &mut Reality, scale: &Scale) {
        let s = self.strength;
        let foreign = &mut reality.foreign;
        let noise = |windows| {
            let every_s = 0.25 / (scale.hz * (1.0 + 4.0 * self.form[1]));
            let mut draw = Draw::seeded(self.seed ^ 1);
            let count = (scale.session_s() * 1.1 / every_s) as usize + 2;
            let values = (0..count)
                .map(|_| s * scale.torque * draw.normal())
                .collect();
            Some(Disturbance::Noise {
                values,
                every_s,
                windows,
            })
        };
        match self.name {
            "torque_noise" => {
                foreign.disturbance = noise(vec![Window {
                    from_s: 0.0,
                    to_s: f64::INFINITY,
                }]);
            }
            "torque_bursts" => foreign.disturbance = noise(windows(self.bursts(scale, 1.0))),
            "torque_tone" => {
                foreign.disturbance = Some(Disturbance::Tone {
                    amplitude: s * scale.torque,
                    hz: self.odd_hz(scale),
                    phase_rad: TAU * self.form[1],
                });
            }
            "breathing_inertia" => {
                foreign.breathing_inertia =
                    Some((s.min(0.8), scale.hz * (0.15 + 0.5 * self.form[0])));
            }
            "swinging_gain" => {
                foreign.swinging_gain = Some((s.min(0.9), scale.hz * (0.15 + 0.5 * self.form[0])));
            }
            "power_dropouts" => foreign.dropouts = windows(self.bursts(scale, s)),
            "rocking_base" => {
                foreign.rocking = Some((s, self.odd_hz(scale) * 0.4));
            }
            "creeping_spring" => {
                foreign.creep = Some(Creep {
                    stiffness: 1.5 * s * scale.torque / scale.half_span,
                    time_s: (0.05 + 0.3 * self.form[0]) / scale.hz,
                });
            }
            _ => reality.sensing.hum = Some((s * scale.half_span, self.odd_hz(scale))),
        }
    }

    /// Intervals in which it acts. Empty if it acts all the time.
    pub fn places(&self, scale: &Scale) -> Vec<Place> {
        let share = match self.name {
            "torque_bursts" => 1.0,
            "power_dropouts" => self.strength,
            _ => return Vec::new(),
        };
        self.bursts(scale, share)
            .iter()
            .map(|(run, window)| Place::in_run(*run, window.from_s, window.to_s + AFTERMATH_S))
            .collect()
    }
}

fn windows(bursts: Vec<(usize, Window)>) -> Vec<Window> {
    bursts.into_iter().map(|(_, window)| window).collect()
}
