//! The same device with another load, driven otherwise: does a model that was found on one recording hold there?

use recording::Recording;

use super::GAP_OVER_FLOOR;
use super::amplitude::size_up;
use super::bench::Bench;
use super::timing::WrongTimes;
use crate::draw::Draw;
use crate::reality::Reality;
use crate::scenario::{Family, Plan};

/// The load that is added, over the device's inertia.
const LOADS: [f64; 2] = [0.2, 0.8];
/// Amplitude and frequency of the other excitation over those of the first, up or down.
const AMPLITUDES: [[f64; 2]; 2] = [[0.4, 0.7], [1.3, 1.8]];
const FREQUENCIES: [[f64; 2]; 2] = [[0.5, 0.75], [1.35, 1.8]];
/// Largest amplitude, of the way to a hard stop and of a rotary axis in rad.
const MOST_OF_TRAVEL: f64 = 0.85;
const MOST_RAD: f64 = 2.0;
/// Excitations drawn before a device is left without such a recording.
const TRIES: usize = 8;

/// A recording of the same device with another excitation, amplitude and load.
#[derive(Clone, Debug)]
pub struct Transfer {
    /// Its manifest states the inertia with the load.
    pub recording: Recording,
    /// What the load adds to the inertia, known to everybody.
    pub load_inertia: f64,
    /// Gap of the true model with its hidden states known, in units of position; `None` where the nominal model hardly fails.
    pub floor: Option<f64>,
}

/// The device `reality` that was on `bench`, with another load and another excitation; `None` if none suits it.
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
    let scale = size_up(&mut plans, &plant, &logging)?;
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
        recording: bench.written_down(&plans, &measured.logs, times, draw),
        load_inertia,
        floor: (reference.before > GAP_OVER_FLOOR[0] * reference.after).then_some(reference.after),
    })
}
