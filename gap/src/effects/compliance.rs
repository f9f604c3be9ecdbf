//! A transmission that twists, between two masses.

use super::identification::{Fitted, Identification, Landscape};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{linear, log, term};
use crate::guess::two_masses::{HALF, is_no_link, rubs, two_masses};
use crate::term::Term;
use crate::windows::series::FINE_PERIOD_S;
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::effects::compliance::KIND;

/// Where a twisting transmission may ring, over the frequency of the motion, and how many resonances are tried: what rings
/// is found within some percent of its frequency only.
const RESONANCES: [f64; 2] = [1.0, 100.0];
const RESONANCE_STARTS: usize = 90;
/// And the highest frequency that samples follow, over their rate.
const HIGHEST_RESONANCE: f64 = 0.2;
/// Its relative damping.
const TWIST_DAMPING: f64 = 0.05;
/// The side on which most of the friction is decides how it rings while one side sticks: shares beyond the twist.
const TWIST_FRICTIONS: [f64; 2] = [0.2, 0.8];

#[derive(Debug)]
pub(super) struct Compliance;

impl Identification for Compliance {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let inertia = e.device.mechanics.inertia;
        let rubs = rubs(e);
        let frictions = if rubs { &TWIST_FRICTIONS[..] } else { &[HALF] };
        let highest = HIGHEST_RESONANCE / s.period_s.max(FINE_PERIOD_S);
        let [low, high] = RESONANCES.map(|ratio| (ratio * s.motion_hz()).min(highest));
        two_masses([low, high], RESONANCE_STARTS, |hertz| {
            let stiffness = (TAU * hertz).powi(2) * inertia * HALF * (1.0 - HALF);
            let damping = 2.0 * TWIST_DAMPING * (stiffness * inertia).sqrt();
            let start = |&friction: &f64| {
                let mut free = vec![log(0, stiffness), log(1, damping), linear(2, HALF, 0.15)];
                free.extend(rubs.then(|| linear(3, friction, 0.3)));
                term(&KIND, free, &[])
            };
            frictions.iter().map(start).collect()
        })
    }

    fn landscape(&self) -> Landscape {
        Landscape::Resonant
    }

    fn resonates(&self) -> bool {
        true
    }

    /// Without a spring that comes back through its damper within a prediction it is a lag; and where one side weighs nothing,
    /// its friction bends.
    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        is_no_link(fit.device, fit.horizon_s)
    }

    fn noun(&self) -> &'static str {
        "a compliant transmission"
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a compliant transmission of {stiffness}"
    }
}
