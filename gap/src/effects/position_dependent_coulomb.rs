//! Coulomb friction that depends on the position.

use super::coulomb::Coulomb;
use super::identification::Identification;
use super::phrase::Found;
use crate::guess::Evidence;
use crate::guess::regression::{moments, regress, regress_in};
use crate::guess::sliding::{best_explaining, friction_nm, has_coulomb_friction, level_ratio};
use crate::guess::start::{guessed, linear, log, term, terms};
use crate::guess::waves;
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::effects::position_dependent_coulomb::KIND;
use host_sim::plant::Spot;

/// Numbers of periods of a ripple over the range of the motion that are tried, and the number of ripples with more periods.
const RIPPLES: [f64; 3] = [0.5, 1.0, 1.8];
const FINE_RIPPLES: usize = 2;
/// Number of positions of a spot with increased friction that are tried, and its widths over the range of the motion.
const SPOT_POSITIONS: usize = 16;
const SPOT_WIDTHS: [f64; 3] = [0.05, 0.1, 0.2];
/// Indices of the parameters `spot` and `spot_exponent`, and an exponent for a shape between a bell and a rectangle.
const SPOT: usize = 6;
const SPOT_EXPONENT: usize = 9;
const STEEP: f64 = 4.0;
/// Positions of a spot and its widths that are screened for the missing torque, over half of the range of the motion.
const SPOTS_SCREENED: [f64; 7] = [-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75];
const SPOT_WIDTHS_SCREENED: [f64; 2] = [0.25, 0.5];

#[derive(Debug)]
pub(super) struct PositionDependentCoulomb;

impl Identification for PositionDependentCoulomb {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Starts of a friction that changes linearly with the position, has a minimum or a maximum, or has a ripple, for example from an
    /// eccentric part.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        if !has_coulomb_friction(e) {
            return Vec::new();
        }
        let s = e.scales;
        let reach = s.position[0].abs().max(s.position[1].abs());
        let guess = regress(e, |m| {
            let friction = friction_nm(e, m);
            [
                friction * m.position,
                friction * m.position * m.position,
                friction,
            ]
        });
        let guess = guess.map(|[slope, curve, more]| {
            vec![
                guessed(0, slope, 0.3 / reach),
                guessed(1, curve, 0.3 / (reach * reach)),
                log(2, level_ratio(more)),
            ]
        });
        let curved = [(0.4, 0.0), (-0.4, 0.0), (0.0, 0.8)].map(|(slope, curve)| {
            vec![
                linear(0, slope / reach, 0.5 / reach),
                linear(1, curve / (reach * reach), 0.5 / (reach * reach)),
                log(2, 1.0),
            ]
        });
        let turn = TAU / s.span();
        let coarse = RIPPLES[2] * turn;
        let ripple = |wave_number: f64| {
            let found = regress(e, |m| {
                let friction = friction_nm(e, m);
                let (sin, cos) = (wave_number * m.position).sin_cos();
                [friction * sin, friction * (cos - 1.0), friction]
            });
            let [sine, cosine, more] = found?;
            let free = vec![
                log(2, level_ratio(more)),
                linear(3, sine, 0.3),
                linear(4, cosine, 0.3),
                linear(5, wave_number, 0.2 * wave_number.min(coarse)),
            ];
            Some(term(&KIND, free, &[(0, 0.0), (1, 0.0)]))
        };
        let resistance = moments(e).map(|m| {
            let resisting_nm = -m.missing_nm * m.velocity.signum();
            (m.position, m.velocity > 0.0, resisting_nm)
        });
        let fine_ripples =
            waves::strongest(resistance.collect(), s.wave_numbers(), s.span()).into_iter();
        let fine_ripples = fine_ripples.map(|(wave_number, _)| wave_number);
        let fine_ripples = fine_ripples.filter(|wave_number| *wave_number > coarse);
        let ripples = RIPPLES.into_iter().map(|turns| turns * turn);
        let ripples = ripples
            .chain(fine_ripples.take(FINE_RIPPLES))
            .filter_map(ripple);
        terms(&KIND, guess, [])
            .into_iter()
            .chain(ripples)
            .chain(spot(e))
            .chain(terms(&KIND, None, curved))
            .collect()
    }

    fn further_shape(&self, fitted: &Term, _half_span: f64) -> Vec<Coordinate> {
        let is_bell = fitted.is_free(SPOT) && !fitted.is_free(SPOT_EXPONENT);
        let flanks = is_bell.then(|| log(SPOT_EXPONENT, STEEP));
        flanks.into_iter().collect()
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&Coulomb]
    }

    fn axis(&self) -> Axis {
        Axis::DirectionAndPosition
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        if path.friction_level() == 0.0 {
            return Vec::new();
        }
        let half = path.scale.half_span();
        let level = [(0, 0.0), (1, 0.0), (2, 1.0)];
        let varied = |more: &[(usize, f64)]| with_defaults(&KIND, &[&level, more].concat());
        let linear_steps = [(0, 0.2 / half), (2, 0.2)];
        let quadratic_steps = [(0, 0.2 / half), (1, 0.2 / (half * half)), (2, 0.2)];
        let mut forms = Vec::new();
        for &place in &SPOTS_SCREENED {
            for &width in &SPOT_WIDTHS_SCREENED {
                let at = path.scale.middle() + place * half;
                let base = varied(&[(7, at), (8, width * half)]);
                forms.push(Form::linear(path, &KIND, &base, &[(SPOT, 0.3)]).searched(2));
            }
        }
        for &wave_number in &target.waves.resisting {
            let base = varied(&[(5, wave_number)]);
            let steps = [(2, 0.2), (3, 0.2), (4, 0.2)];
            forms.push(Form::linear(path, &KIND, &base, &steps).searched(1));
        }
        let mut forms = target.screened(forms, 2);
        forms.push(Form::linear(path, &KIND, &varied(&[]), &linear_steps));
        forms.push(Form::linear(path, &KIND, &varied(&[]), &quadratic_steps));
        forms
    }

    fn noun(&self) -> &'static str {
        "dry friction that depends on the position"
    }

    fn tell_apart(&self) -> &'static str {
        "The torque turns with the motion and its size goes with the position. Cogging, a weight and a spring keep their sign. Record slow motion both ways over the whole travel."
    }

    fn template(&self, found: &Found<'_>) -> &'static str {
        match found.fitted("spot") {
            Some(_) => "dry friction that differs around {spot_position}",
            None => "dry friction that depends on the position",
        }
    }
}

/// A spot with another friction, at the position at which it explains most.
fn spot(e: &Evidence<'_>) -> Option<Term> {
    let [low, high] = e.scales.position;
    let places = (0..SPOT_POSITIONS).map(|k| (k as f64 + 0.5) / SPOT_POSITIONS as f64);
    let places = places.map(|share| low + share * (high - low));
    let spots = places.flat_map(|place| SPOT_WIDTHS.map(|width| (place, width * e.scales.span())));
    let tried = spots.filter_map(|(position, width)| {
        let shape = Spot {
            height: 1.0,
            position,
            width,
            exponent: Spot::BELL,
        };
        let found = regress_in(moments(e), |m| {
            let friction = friction_nm(e, m);
            [friction * shape.at(m.position), friction]
        });
        let ([height, more], explained) = found?;
        let free = vec![
            log(2, level_ratio(more)),
            guessed(SPOT, height, 0.3),
            linear(7, position, width),
            log(8, width),
        ];
        Some((explained, term(&KIND, free, &[(0, 0.0), (1, 0.0)])))
    });
    best_explaining(tried)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn starts_contain_the_wave_number_of_a_fine_friction_ripple() {
        const WAVE_NUMBER: f64 = 40.0;
        let rippled = format!("{}:ripple_sine=0.8,wave_number={WAVE_NUMBER}", KIND.name);
        let near = |e: &Evidence<'_>| {
            let turn = TAU / e.scales.span();
            assert!(WAVE_NUMBER > 2.0 * RIPPLES[2] * turn);
            let starts = PositionDependentCoulomb.starts(e).into_iter();
            let fine_ripples = starts.filter(|start| start.values[3] > 0.4);
            let mut off = fine_ripples.map(|start| (start.values[5] - WAVE_NUMBER).abs());
            off.any(|off| off < 0.3 * turn)
        };
        assert!(made::seen(&[&rippled], |_| (), near));
    }
}
