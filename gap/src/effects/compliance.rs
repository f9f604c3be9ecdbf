//! A compliant transmission between two masses.

use super::identification::{Fitted, Identification, Landscape};
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::start::{geometric, linear, log, term};
use crate::guess::two_masses::{HALF, has_friction, is_degenerate_link, two_masses};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::Term;
use crate::windows::series::FINE_PERIOD_S;
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::effects::compliance::KIND;

/// Lowest and highest resonance that are tried, over the frequency of the motion, and their number. A fit converges only from within some
/// percent of the resonance.
const RESONANCES: [f64; 2] = [1.0, 100.0];
const RESONANCE_STARTS: usize = 90;
/// Highest frequency that samples resolve, over the sampling rate.
const HIGHEST_RESONANCE: f64 = 0.2;
/// Damping ratio of the resonance at the start.
const TWIST_DAMPING: f64 = 0.05;
/// Shares of the friction on the load side that are tried. The side with most of the friction determines the oscillation while the other
/// side moves.
const TWIST_FRICTIONS: [f64; 2] = [0.2, 0.8];
/// Lowest and highest resonance that are screened for the missing torque, over the angular frequency of the motion. The following
/// constants are their number in geometric progression, the number of forms, and the damping ratio.
const RESONANCES_SCREENED: [f64; 2] = [1.5, 40.0];
const RESONANCES_TRIED: usize = 70;
const RESONANCES_KEPT: usize = 2;
const SCREENED_DAMPING: f64 = 0.03;

#[derive(Debug)]
pub(super) struct Compliance;

impl Identification for Compliance {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        let s = e.scales;
        let inertia = e.device.mechanics.inertia;
        let has_friction = has_friction(e);
        let frictions = if has_friction {
            &TWIST_FRICTIONS[..]
        } else {
            &[HALF]
        };
        let highest = HIGHEST_RESONANCE / s.period_s.max(FINE_PERIOD_S);
        let [low, high] = RESONANCES.map(|ratio| (ratio * s.motion_hz()).min(highest));
        two_masses([low, high], RESONANCE_STARTS, |hertz| {
            let stiffness = (TAU * hertz).powi(2) * inertia * HALF * (1.0 - HALF);
            let damping = 2.0 * TWIST_DAMPING * (stiffness * inertia).sqrt();
            let start = |&friction: &f64| {
                let mut free = vec![log(0, stiffness), log(1, damping), linear(2, HALF, 0.15)];
                free.extend(has_friction.then(|| linear(3, friction, 0.3)));
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

    /// If the damper prevents the spring from relaxing within a prediction, the effect acts like a lag. If one side has no inertia, the
    /// transmission acts like presliding friction.
    fn is_degenerate(&self, fit: &Fitted<'_>) -> bool {
        is_degenerate_link(fit.device, fit.horizon_s)
    }

    fn axis(&self) -> Axis {
        Axis::Acceleration
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let carried = path.transmitted_torque();
        let inertia = path.device.mechanics.inertia;
        let [lowest, highest] = RESONANCES_SCREENED.map(|part| part * path.scale.rate());
        // The smoother does not resolve higher resonances.
        let highest = highest.min(target.corner).max(1.1 * lowest);
        let rates = geometric([lowest, highest], RESONANCES_TRIED);
        let tried = rates.map(|rate| {
            let column = above_resonance(path, &carried, rate);
            (
                target.explained(core::slice::from_ref(&column)),
                rate,
                column,
            )
        });
        let mut tried: Vec<(f64, f64, Vec<f64>)> = tried.collect();
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        tried.truncate(RESONANCES_KEPT);
        // Both masses oscillate in opposite phase. For two masses and a spring between them, `J s² x/T − 1` is `s²/(s² + ω²)` times the
        // ratio of the masses at the motor, and −1 times that at the load.
        let forms = tried.into_iter().map(|(_, rate, column)| {
            Form::new(vec![column], move |c| {
                let load = if c[0] > 0.0 { c[0] / (1.0 + c[0]) } else { 0.5 };
                let load = load.clamp(0.1, 0.9);
                let stiffness = load * (1.0 - load) * inertia * rate * rate;
                with_defaults(&KIND, &[(0, stiffness), (2, load)])
            })
            .searched(1)
        });
        forms.collect()
    }

    fn noun(&self) -> &'static str {
        "a compliant transmission"
    }

    fn tell_apart(&self) -> &'static str {
        "The motion rings at one frequency. With backlash this frequency depends on the amplitude. A lag does not ring. Record a chirp through the resonance."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "a compliant transmission of {stiffness}"
    }
}

/// The part of a torque above a resonance, over each step.
fn above_resonance(path: &Path<'_>, torque: &[f64], rate: f64) -> Vec<f64> {
    let (mut y, mut w) = (0.0, 0.0);
    let steps = torque.iter().zip(&path.samples.step_s);
    let above = steps.map(|(torque, &step_s)| {
        if step_s == 0.0 {
            (y, w) = (0.0, 0.0);
            return 0.0;
        }
        // Integration steps of at most a fifth of a radian.
        let count = (5.0 * rate * step_s).ceil().max(1.0);
        let t = step_s / count;
        for _ in 0..count as usize {
            w += t * (rate * rate * (torque - y) - 2.0 * SCREENED_DAMPING * rate * w);
            y += t * w;
        }
        torque - y
    });
    above.collect()
}
