//! Stribeck friction: static friction above the sliding level.

use super::coulomb::Coulomb;
use super::identification::Identification;
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::sliding::has_coulomb_friction;
use crate::guess::start::{linear, log, term};
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::statistics::quantile;
use host_sim::effects::Kind;
use host_sim::effects::stribeck::KIND;

/// Starts of the exponent, and the indices of the parameters `exponent` and `tail`.
const EXPONENTS: [f64; 2] = [2.0, 1.0];
const EXPONENT: usize = 2;
const TAIL: usize = 3;
/// Start of `tail`: half way between an exponential and a hyperbolic decrease.
const SOME_TAIL: f64 = 0.5;
/// Starts of the static friction above the sliding level, as a share of that level, and of the Stribeck velocity over the rms velocity.
const STARTS: [(f64, f64); 4] = [(0.1, 0.15), (0.4, 0.03), (0.4, 0.15), (1.0, 0.4)];
/// Starts of the Stribeck velocity, over the rms velocity, if the static level is estimated from standstill, and a factor on that level.
const STANDSTILL_VELOCITIES: [f64; 2] = [0.03, 0.15];
const STANDSTILL_MARGIN: f64 = 1.05;
/// Quantile of the torque during standstill, and largest inertial torque at standstill, as a share of the friction. At a reversal the
/// joint accelerates, so it is no standstill.
const STANDSTILL_QUANTILE: f64 = 0.98;
const LARGEST_INERTIAL_SHARE: f64 = 0.1;
/// Stribeck velocities that are screened for the missing torque, over the rms velocity.
const VELOCITIES_SCREENED: [f64; 6] = [0.02, 0.04, 0.08, 0.15, 0.3, 0.6];

#[derive(Debug)]
pub(super) struct Stribeck;

impl Identification for Stribeck {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        if !has_coulomb_friction(e) {
            return Vec::new();
        }
        let held = least_static_excess(e).into_iter();
        let held = held.flat_map(|rise| STANDSTILL_VELOCITIES.map(|v| (rise, v)));
        let starts = STARTS.into_iter().chain(held).flat_map(|(rise, v)| {
            let free = vec![linear(0, 1.0 + rise, 0.3), log(1, v * e.scales.velocity)];
            EXPONENTS.map(|exponent| term(&KIND, free.clone(), &[(EXPONENT, exponent)]))
        });
        starts.collect()
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        if fitted.is_free(EXPONENT) {
            return Vec::new();
        }
        vec![
            log(EXPONENT, fitted.values[EXPONENT]),
            linear(TAIL, SOME_TAIL, SOME_TAIL),
        ]
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&Coulomb]
    }

    fn axis(&self) -> Axis {
        Axis::Velocity
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        if path.friction_level() == 0.0 {
            return Vec::new();
        }
        let starts = VELOCITIES_SCREENED.iter().flat_map(|part| {
            [1.0, 2.0].map(|exponent| {
                let velocity = part * path.scale.velocity;
                let base = [(0, 1.0), (1, velocity), (EXPONENT, exponent)];
                let base = with_defaults(&KIND, &base);
                Form::linear(path, &KIND, &base, &[(0, 0.5)])
                    .searched(1)
                    .positive()
            })
        });
        target.screened(starts.collect(), 2)
    }

    fn noun(&self) -> &'static str {
        "static friction"
    }

    fn tell_apart(&self) -> &'static str {
        "The missing torque is a peak at low speed against the motion. Another level of dry friction is as high at all speeds. Presliding lacks torque before the joint slides. Record slow triangles that stop and start."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "static friction {static_ratio} times the sliding level"
    }
}

/// Static friction above the sliding level that is at least required for the observed standstills, as a share of the sliding level.
fn least_static_excess(e: &Evidence<'_>) -> Option<f64> {
    let m = &e.device.mechanics;
    let level = m.friction.highest_nm();
    let standstill_torques = e.motions.iter().flat_map(|motion| {
        let all = motion.held_nm.iter().zip(&motion.acceleration);
        all.filter(|(_, a)| m.inertia * a.abs() < LARGEST_INERTIAL_SHARE * level)
            .map(|(held, _)| held.abs())
    });
    let standstill_torques: Vec<f64> = standstill_torques.filter(|held| held.is_finite()).collect();
    let rise = STANDSTILL_MARGIN * quantile(&standstill_torques, STANDSTILL_QUANTILE) / level - 1.0;
    (rise > 0.0).then_some(rise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::windows::motion::Motion;

    /// Lower bound of the static friction above the sliding level from torques, N m, and accelerations during standstill.
    fn excess(held: &[(f64, f64)]) -> Option<f64> {
        let hold = |motions: &mut [Motion]| {
            for motion in motions.iter_mut() {
                motion.held_nm.fill(f64::NAN);
            }
            for (i, (held_nm, acceleration)) in held.iter().enumerate() {
                motions[0].held_nm[i] = *held_nm;
                motions[0].acceleration[i] = *acceleration;
            }
        };
        made::seen(&[], hold, least_static_excess)
    }

    #[test]
    fn standstill_gives_a_lower_bound_of_static_friction() {
        let level = made::recording(&[]).model.coulomb;
        assert_eq!(excess(&[]), None);
        assert_eq!(excess(&[(0.9 * level, 0.0)]), None);
        let rise = excess(&[(1.6 * level, 0.0), (-1.6 * level, 0.0), (0.2 * level, 0.0)]).unwrap();
        assert!(
            (rise + 1.0 - 1.6 * STANDSTILL_MARGIN).abs() < 1e-9,
            "{rise}"
        );
        // At a reversal, the inertia takes a part of the torque.
        assert_eq!(excess(&[(0.9 * level, 0.0), (3.0 * level, 50.0)]), None);
    }
}
