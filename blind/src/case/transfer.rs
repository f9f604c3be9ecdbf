//! Makes a recording of the same device with another load and another excitation. It tests whether a corrected model holds
//! there.

use recording::Recording;

use super::GAP_OVER_FLOOR;
use super::amplitude::set_amplitudes;
use super::bench::Bench;
use super::timing::WrongTimes;
use crate::draw::Draw;
use crate::reality::Reality;
use crate::scenario::{Family, Plan};

/// Least and largest added inertia over the inertia of the device.
const LOADS: [f64; 2] = [0.2, 0.8];
/// Ranges of the new amplitude over the old one.
const AMPLITUDES: [[f64; 2]; 2] = [[0.4, 0.7], [1.3, 1.8]];
/// Ranges of the new frequency over the old one.
const FREQUENCIES: [[f64; 2]; 2] = [[0.5, 0.75], [1.35, 1.8]];
/// Largest amplitude over the distance to the nearer hard stop.
const MOST_OF_TRAVEL: f64 = 0.85;
/// Largest amplitude of a rotary axis, rad.
const MOST_RAD: f64 = 2.0;
/// Number of excitations drawn before the transfer recording is left out.
const TRIES: usize = 8;

/// A recording of the same device with another excitation, amplitude and load.
#[derive(Clone, Debug)]
pub struct Transfer {
    /// The recording. Its manifest states the inertia including the load.
    pub recording: Recording,
    /// Inertia that the load adds. The scorer adds it to the corrected model.
    pub load_inertia: f64,
    /// Gap of the true model with known hidden states, in units of position. `None` if the gap of the nominal model is too
    /// small to judge.
    pub floor: Option<f64>,
}

/// Records the device `reality` of `bench` with another load and excitation. Returns `None` if no drawn excitation suits it.
pub(super) fn transfer(
    draw: &mut Draw,
    bench: &Bench,
    reality: &Reality,
    times: WrongTimes,
) -> Option<Transfer> {
    (0..TRIES).find_map(|_| attempt(&mut draw.split(), bench, reality, times))
}

fn attempt(
    draw: &mut Draw,
    bench: &Bench,
    reality: &Reality,
    times: WrongTimes,
) -> Option<Transfer> {
    let mut plant = bench.plant.clone();
    let load_inertia = plant.model.inertia * draw.uniform(LOADS[0], LOADS[1]);
    plant.model.inertia += load_inertia;
    let [low, high] = draw.pick(&AMPLITUDES);
    plant.amplitude *= draw.uniform(low, high);
    if let Some([low, high]) = plant.model.travel {
        plant.amplitude = plant
            .amplitude
            .min(MOST_OF_TRAVEL * low.abs().min(high.abs()));
    }
    if plant.family != Family::Linear {
        plant.amplitude = plant.amplitude.min(MOST_RAD);
    }
    let [low, high] = draw.pick(&FREQUENCIES);
    plant.motion_hz *= draw.log_uniform(low, high);

    let mut loaded = reality.clone();
    if let Some(coupling) = &mut loaded.mechanics.coupling {
        let inertia = loaded.mechanics.inertia;
        coupling.motor_share *= inertia / (inertia + load_inertia);
    }
    loaded.mechanics.inertia += load_inertia;

    let mut nominal = bench.nominal;
    nominal.inertia += load_inertia;
    let mut logging = bench.logging.clone();
    logging.step_s *= bench.plant.motion_hz / plant.motion_hz;
    let mut plans = Plan::session(draw, &plant);
    let scale = set_amplitudes(&mut plans, &plant, &logging)?;
    let bench = Bench {
        plant,
        nominal,
        tolerance: bench.tolerance.clone(),
        logging,
        restart: bench.restart,
        per_run_clocks: bench.per_run_clocks,
    };
    let measured = bench.measure(&loaded, &plans, &scale)?;
    let reference = measured.reference;
    Some(Transfer {
        recording: bench.recording_with_timing(&plans, &measured.logs, times, draw),
        load_inertia,
        floor: (reference.before > GAP_OVER_FLOOR[0] * reference.after).then_some(reference.after),
    })
}
