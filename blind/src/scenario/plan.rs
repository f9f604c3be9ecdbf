//! Plans each run: its drive, and the times of its control ticks and rows.

use std::f64::consts::TAU;

use recording::Pid;

use super::{Plant, Waveform};
use crate::draw::Draw;

/// Source of the input of a run.
#[derive(Clone, Debug)]
pub(crate) enum Drive {
    Open {
        amplitude: f64,
        course: Waveform,
    },
    Closed {
        pid: Pid,
        amplitude: f64,
        course: Waveform,
    },
}

/// One run before it is simulated.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub drive: Drive,
    /// Times at which the control loop acts, in the time of the session. The last one is the end of the run.
    pub ticks_s: Vec<f64>,
    /// Indices of the ticks that are logged.
    pub rows: Vec<usize>,
    /// Seed of the sensor noise.
    pub noise_seed: u64,
}

/// Largest number of runs in a session.
const MOST_RUNS: usize = 4;

impl Plan {
    /// Draws the runs of a session on `plant`, together 5 to 20 s.
    pub fn session(draw: &mut Draw, plant: &Plant) -> Vec<Self> {
        let total_s = draw.uniform(5.0, 20.0);
        let most = ((total_s / 2.5) as usize).clamp(1, MOST_RUNS);
        let count = draw.count(1, most);
        let closed_share = match plant.family {
            super::plant::Family::Servo => 0.85,
            super::plant::Family::Paddle => 0.5,
            _ => 0.6,
        };
        let mixed = draw.chance(0.4);
        let all_closed = draw.chance(closed_share);
        let jitter = draw.chance(0.35).then(|| draw.log_uniform(0.01, 0.15));
        let dropped_rows = if draw.chance(0.15) {
            draw.uniform(0.002, 0.02)
        } else {
            0.0
        };
        let mut start_s = 0.0;
        let mut plans = Vec::with_capacity(count);
        for k in 0..count {
            let duration_s = total_s / count as f64 * draw.uniform(0.8, 1.2);
            let rich = count == 1 || k == 0;
            let hz = plant.motion_hz * draw.log_uniform(0.7, 1.4);
            let course = Waveform::draw(draw, hz, duration_s, rich);
            let closed = if mixed {
                draw.chance(closed_share)
            } else {
                all_closed
            };
            let amplitude = plant.amplitude * if k == 0 { 1.0 } else { draw.uniform(0.45, 1.0) };
            let drive = if closed {
                Drive::Closed {
                    pid: pid(draw, plant),
                    amplitude,
                    course,
                }
            } else {
                Drive::Open { amplitude, course }
            };
            let ticks_s = ticks(draw, plant, start_s, duration_s, jitter);
            let rows = (0..ticks_s.len() - 1)
                .step_by(plant.ticks_per_row)
                .filter(|row| *row == 0 || !draw.chance(dropped_rows))
                .collect();
            start_s = (ticks_s[ticks_s.len() - 1] + draw.uniform(0.3, 4.0)).ceil();
            plans.push(Self {
                drive,
                ticks_s,
                rows,
                noise_seed: draw.seed(),
            });
        }
        plans
    }
}

/// Draws a PID controller that follows the motion with a stability margin.
fn pid(draw: &mut Draw, plant: &Plant) -> Pid {
    let model = &plant.model;
    let fastest = 0.3 / (plant.tick_s + model.delay + model.lag);
    let bandwidth = (TAU * plant.motion_hz * draw.uniform(3.0, 7.0)).min(fastest);
    let damping = draw.uniform(0.5, 1.0);
    let significant = |x: f64| {
        let digits = 10f64.powi(4 - x.abs().log10().floor() as i32);
        (x * digits).round() / digits
    };
    let kp = significant(model.inertia * bandwidth * bandwidth / model.ratio);
    Pid {
        kp,
        ki: if draw.chance(0.2) {
            significant(kp * bandwidth * 0.1)
        } else {
            0.0
        },
        kd: significant(2.0 * damping * model.inertia * bandwidth / model.ratio),
        period: plant.tick_s,
        position_cutoff_hz: (plant.tick_s < 2e-3).then_some(100.0),
    }
}

fn ticks(
    draw: &mut Draw,
    plant: &Plant,
    start_s: f64,
    duration_s: f64,
    jitter: Option<f64>,
) -> Vec<f64> {
    let count = (duration_s / plant.tick_s) as usize / plant.ticks_per_row * plant.ticks_per_row;
    let mut now_s = start_s;
    let mut ticks_s = vec![start_s];
    for k in 1..=count {
        now_s = match jitter {
            None => start_s + k as f64 * plant.tick_s,
            Some(relative) => now_s + plant.tick_s * (1.0 + relative * draw.normal_within(3.0)),
        };
        // A log prints times with seven decimals.
        ticks_s.push((now_s * 1e7).round() / 1e7);
    }
    ticks_s
}
