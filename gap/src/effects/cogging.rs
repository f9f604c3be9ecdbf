//! Torque ripple over the position. Wave numbers are searched before any fit.

use super::gravity::Gravity;
use super::identification::Identification;
use super::phrase::{Found, Phrase};
use super::spring::Spring;
use super::torque_offset::TorqueOffset;
use crate::guess::Evidence;
use crate::guess::regression::{Moment, moments};
use crate::guess::start::{linear, log, term};
use crate::guess::waves;
use crate::missing_torque::axis::Axis;
use crate::missing_torque::form::{Form, with_defaults};
use crate::missing_torque::path::Path;
use crate::missing_torque::target::Target;
use crate::term::{Coordinate, Term};
use crate::windows::statistics::quantile;
use core::f64::consts::{FRAC_PI_2, TAU};
use host_sim::effects::Kind;
use host_sim::effects::cogging::KIND;

/// Number of starts among the wave numbers that the samples resolve at the rms speed, and again among higher ones.
const PEAKS: usize = 3;
/// Share of the instants that count as slow.
const SLOW_SHARE: f64 = 0.25;
/// Least number of periods within the motion that shows a ripple to be periodic.
const LEAST_WAVES: f64 = 1.0;
/// Offset of the parameter wave number.
const WAVE_NUMBER: usize = 1;

#[derive(Debug)]
pub(super) struct Cogging;

impl Identification for Cogging {
    fn kind(&self) -> &'static Kind {
        &KIND
    }

    /// Starts at the wave numbers whose sine and cosine have the largest amplitudes in the missing torque.
    fn starts(&self, e: &Evidence<'_>) -> Vec<Term> {
        peaks(e)
            .into_iter()
            .map(|wave| {
                let harmonic = 0.3 * wave.amplitude;
                let mut free = wave.coordinates(e, 0).to_vec();
                free.extend([linear(3, 0.0, harmonic), linear(4, 0.0, harmonic)]);
                term(&KIND, free, &[])
            })
            .collect()
    }

    fn with_another_part(&self, fitted: &Term, e: &Evidence<'_>) -> Vec<Term> {
        let place = fitted.values.len();
        if KIND.event_count(&fitted.values) >= KIND.most_events() {
            return Vec::new();
        }
        let known = KIND.event_count(&fitted.values);
        let known = (0..known).map(|k| fitted.values[KIND.event_place(k) + WAVE_NUMBER]);
        let known: Vec<f64> = known.collect();
        let resolved = TAU / e.scales.span();
        let mut all = peaks(e);
        all.retain(|wave| {
            let distances = known.iter().map(|n| (n - wave.wave_number).abs());
            distances.fold(f64::INFINITY, f64::min) > resolved
        });
        let more = all.into_iter().map(|wave| {
            let mut term = fitted.clone();
            term.values
                .extend([wave.amplitude, wave.wave_number, wave.phase]);
            term.free.extend(wave.coordinates(e, place));
            term
        });
        more.collect()
    }

    fn special_cases(&self) -> &'static [&'static dyn Identification] {
        &[&TorqueOffset, &Gravity, &Spring]
    }

    fn too_few_periods(&self, fitted: &Term, extremes: [f64; 2]) -> Option<f64> {
        let waves = 0..KIND.event_count(&fitted.values);
        let numbers = waves.map(|k| fitted.values[KIND.event_place(k) + WAVE_NUMBER]);
        too_few_waves(numbers.fold(f64::INFINITY, f64::min), extremes)
    }

    fn axis(&self) -> Axis {
        Axis::Wave
    }

    fn torque_forms(&self, path: &Path<'_>, target: &Target<'_>) -> Vec<Form> {
        let forms = target.waves.strongest.iter().map(|&wave_number| {
            let wave = |shift: f64| -> Vec<f64> {
                let positions = path.position.iter();
                positions.map(|x| (wave_number * x + shift).sin()).collect()
            };
            let columns = vec![wave(0.0), wave(FRAC_PI_2)];
            let form = Form::new(columns, move |c| {
                let (amplitude, phase) = (c[0].hypot(c[1]), c[1].atan2(c[0]));
                let values = [(0, amplitude), (WAVE_NUMBER, wave_number), (2, phase)];
                with_defaults(&KIND, &values)
            });
            form.searched(1)
        });
        forms.collect()
    }

    fn noun(&self) -> &'static str {
        "cogging"
    }

    fn tell_apart(&self) -> &'static str {
        "A wave over position that repeats. Over less than two waves it cannot be told from a spring, a weight or an offset. Cogging has one sign in both directions; friction that depends on position turns with the motion. Record slow motion over several waves."
    }

    fn template(&self, _found: &Found<'_>) -> &'static str {
        "cogging of {amplitude}"
    }

    fn phrase(&self, found: &Found<'_>) -> Phrase {
        match found.count("wave_number") {
            0 | 1 => self.filled_template(found),
            orders => Phrase::of(format!("cogging of {orders} orders")),
        }
    }
}

/// A wave in the missing torque.
#[derive(Clone, Copy, Debug)]
struct Peak {
    amplitude: f64,
    wave_number: f64,
    phase: f64,
}

impl Peak {
    /// Coordinates of amplitude, wave number and phase, whose parameters start at index `first`.
    fn coordinates(&self, e: &Evidence<'_>, first: usize) -> [Coordinate; 3] {
        [
            log(first, self.amplitude),
            linear(
                first + WAVE_NUMBER,
                self.wave_number,
                0.2 * TAU / e.scales.span(),
            ),
            linear(first + 2, self.phase, 0.5),
        ]
    }
}

/// The strongest waves in the missing torque. Those that the samples resolve at the rms speed come first.
fn peaks(e: &Evidence<'_>) -> Vec<Peak> {
    let s = e.scales;
    let known: Vec<Moment> = moments(e).collect();
    let speeds: Vec<f64> = known.iter().map(|m| m.velocity.abs()).collect();
    let slow = quantile(&speeds, SLOW_SHARE);
    let strongest = |fastest: f64, range: [f64; 2]| {
        let some = known.iter().filter(|m| m.velocity.abs() <= fastest);
        let some = some.map(|m| (m.position, m.velocity > 0.0, m.missing_nm));
        waves::strongest(some.collect(), range, s.span())
    };
    let all = strongest(f64::INFINITY, s.wave_numbers());
    // A ripple of a higher wave number is resolved only where the motion is slow.
    let finest = s.finest_wave_number();
    let resolved = waves::highest_resolved(finest, s.span());
    let finer = s.finest_wave_number_at(slow).min(resolved);
    let fine = strongest(slow, [finest, finer]);
    let peaks = all.into_iter().take(PEAKS);
    let peaks = peaks.chain(fine.into_iter().take(PEAKS));
    let peaks = peaks.map(|(wave_number, [a, b])| Peak {
        amplitude: a.hypot(b).max(1e-3 * s.torque),
        wave_number,
        // The missing torque is the torque that the motion needed, so it has the phase of the ripple.
        phase: b.atan2(a),
    });
    peaks.collect()
}

/// Number of periods between the lowest and the highest position, if they are too few to show that the ripple is periodic.
fn too_few_waves(wave_number: f64, [low, high]: [f64; 2]) -> Option<f64> {
    let travelled = wave_number * (high - low) / TAU;
    (travelled < LEAST_WAVES).then_some(travelled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn a_ripple_beyond_the_resolution_at_the_rms_speed_is_found_in_slow_motion() {
        const WAVE_NUMBER: f64 = 120.0;
        let hidden = format!("cogging:amplitude=0.004,wave_number={WAVE_NUMBER},phase=0");
        let nearest = made::seen(
            &[&hidden],
            |_| (),
            |e| {
                assert!(WAVE_NUMBER > e.scales.finest_wave_number());
                let starts = Cogging.starts(e).into_iter();
                let off = starts.map(|start| (start.values[1] - WAVE_NUMBER).abs());
                off.fold(f64::INFINITY, f64::min) / (TAU / e.scales.span())
            },
        );
        assert!(nearest < 0.5, "{nearest} turns off");
    }
}
