//! What resists motion.

use super::Evidence;
use super::regression::{Moment, moments, regress, regress_in};
use super::start::{guessed, linear, log, term, terms};
use super::waves;
use crate::fit::hypothesis::{Coordinate, Term};
use crate::windows::motion::quantile;
use crate::windows::series::FINE_PERIOD_S;
use core::f64::consts::TAU;
use host_sim::effects::Kind;
use host_sim::plant::Spot;

/// How suddenly a static friction may fall with speed, and the places of that and of its tail among its parameters.
const FALLS: [f64; 2] = [2.0, 1.0];
const EXPONENT: usize = 2;
const TAIL: usize = 3;
/// Half way from an exponential to a hyperbola.
const SOME_TAIL: f64 = 0.5;
/// Its rise over the sliding level, and its velocity over that of the motion.
const RISES: [(f64, f64); 4] = [(0.1, 0.15), (0.4, 0.03), (0.4, 0.15), (1.0, 0.4)];
/// Velocities of what is read off rests, likewise, and how far its rise goes beyond what was held.
const HELD_FALLS: [f64; 2] = [0.03, 0.15];
const HELD_MARGIN: f64 = 1.05;
/// Share of the rests that held no more, and of the friction that inertia may take there: at a reversal nothing rests.
const HELD: f64 = 0.98;
const RESTS: f64 = 0.1;
/// Natural frequency of bristles, in rad a coarse sample.
const RESOLVED_RATE: f64 = 2.0;
/// How far they bend, over the span of the motion: from those that are hardly softer than stick on.
const BENDS: [f64; 6] = [3e-5, 3e-4, 0.003, 0.015, 0.06, 0.2];
/// Their damping over that of the springs that bend alike, as a share of the critical one.
const BRISTLE_DAMPING: f64 = 0.3;
/// Periods of a ripple over the span of the motion, and how many of more periods are tried.
const RIPPLES: [f64; 3] = [0.5, 1.0, 1.8];
const FINE_RIPPLES: usize = 2;
/// Places of a spot that rubs, and its width over the span of the motion.
const SPOT_PLACES: usize = 16;
const SPOT_WIDTHS: [f64; 3] = [0.05, 0.1, 0.2];
/// Places among the parameters of its height and of how steep its flanks are, and flanks between a bell's and a wall.
const SPOT: usize = 6;
const SPOT_EXPONENT: usize = 9;
const STEEP: f64 = 4.0;
/// Part of the pull of gravity and springs that a friction that grows with load may grow with, beside that of the drive.
const PASSIVE: [f64; 3] = [1.0, -1.0, 10.0];
/// Time constants with which a friction settles, over the duration.
const SETTLINGS: [f64; 2] = [0.15, 0.5];
/// Places among the parameters of its drift of whether every run starts with it, and whether it settles at the model's level.
const ANEW: usize = 2;
const SETTLED: usize = 3;
/// And of a step of its level, and of when that comes; and instants at which one is looked for.
const STEP: usize = 4;
const STEP_AT: usize = 5;
const STEPS: usize = 48;

pub(super) fn starts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let m = &e.device.mechanics;
    let level = m.friction.level_nm;
    let is_dry = m.friction.highest_nm() > 0.0;
    let viscous_scale = 0.1 * s.torque / s.velocity;
    let drag_scale = 0.1 * s.torque / s.velocity.powi(2);
    match kind.name {
        "coulomb" => {
            let guess = regress(e, |m| [-m.velocity.signum()]);
            let guess = guess.map(|[f]| vec![log(0, (level[0] + f).max(0.05 * s.friction))]);
            // A friction that is not there at all is at the end of a linear scale only.
            let none = vec![linear(0, 0.02 * s.friction, 0.1 * s.friction)];
            let [less, more] = [0.6, 1.4].map(|f| vec![log(0, f * s.friction)]);
            terms(kind, guess, [less, more, none])
        }
        "asymmetric_coulomb" => {
            let guess = regress(e, |m| {
                let forward = f64::from(m.velocity > 0.0);
                [-forward, 1.0 - forward]
            });
            let both = |[forward, backward]: [f64; 2]| vec![log(0, forward), log(1, backward)];
            let least = 0.05 * s.friction;
            let guess =
                guess.map(|[p, n]| both([(level[0] + p).max(least), (level[1] + n).max(least)]));
            let tried = [[0.7, 1.3], [1.3, 0.7]];
            terms(
                kind,
                guess,
                tried.map(|pair| both(pair.map(|f| f * s.friction))),
            )
        }
        "position_dependent_coulomb" if is_dry => position_dependent(kind, e),
        "stribeck" if is_dry => {
            let held = held_rise(e).into_iter();
            let held = held.flat_map(|rise| HELD_FALLS.map(|v| (rise, v)));
            let falls = RISES.into_iter().chain(held).flat_map(|(rise, v)| {
                let free = vec![linear(0, 1.0 + rise, 0.3), log(1, v * s.velocity)];
                FALLS.map(|exponent| term(kind, free.clone(), &[(EXPONENT, exponent)]))
            });
            falls.collect()
        }
        "viscous" => {
            let guess = regress(e, |m| [-m.velocity]);
            let guess = guess.map(|[b]| vec![guessed(0, (m.viscous + b).max(0.0), viscous_scale)]);
            terms(kind, guess, [vec![linear(0, m.viscous, viscous_scale)]])
        }
        "quadratic_drag" => {
            let guess = regress(e, |m| [-m.velocity * m.velocity.abs()]);
            let guess = guess.map(|[q]| vec![guessed(0, q.max(0.0), drag_scale)]);
            terms(kind, guess, [vec![linear(0, 0.0, drag_scale)]])
        }
        "presliding" if is_dry => BENDS.iter().flat_map(|&f| bristles(kind, e, f)).collect(),
        "load_dependent_friction" => {
            let guess = regress(e, |m| [-m.drive_nm.abs() * m.velocity.signum()]);
            let guess = guess.map(|[share]| vec![log(0, share.max(0.01))]);
            let mut starts = terms(kind, guess, [0.05, 0.2].map(|share| vec![log(0, share)]));
            if m.is_pulled() {
                let carried = PASSIVE.map(|part| vec![log(0, 0.1), linear(1, part, 1.0)]);
                starts.extend(terms(kind, None, carried));
            }
            starts
        }
        "friction_drift" if is_dry => drifts(kind, e),
        _ => Vec::new(),
    }
}

/// More of a friction's shape, where that was given: how suddenly static friction falls and how long it lasts, and how steep
/// the flanks of a spot that rubs are.
pub(super) fn shape(given: &Term) -> Option<Vec<Coordinate>> {
    match given.kind.name {
        "stribeck" if !given.is_free(EXPONENT) => Some(vec![
            log(EXPONENT, given.values[EXPONENT]),
            linear(TAIL, SOME_TAIL, SOME_TAIL),
        ]),
        "position_dependent_coulomb" if given.is_free(SPOT) && !given.is_free(SPOT_EXPONENT) => {
            Some(vec![log(SPOT_EXPONENT, STEEP)])
        }
        _ => None,
    }
}

/// Rise of static friction over the sliding level without which what was seen at rest would have slid.
fn held_rise(e: &Evidence<'_>) -> Option<f64> {
    let m = &e.device.mechanics;
    let level = m.friction.highest_nm();
    let rests = e.motions.iter().flat_map(|motion| {
        let all = motion.held_nm.iter().zip(&motion.acceleration);
        all.filter(|(_, a)| m.inertia * a.abs() < RESTS * level)
            .map(|(held, _)| held.abs())
    });
    let rests: Vec<f64> = rests.filter(|held| held.is_finite()).collect();
    let rise = HELD_MARGIN * quantile(&rests, HELD) / level - 1.0;
    (rise > 0.0).then_some(rise)
}

/// Friction of the first level while sliding, N m.
fn sliding_nm(e: &Evidence<'_>, m: &Moment) -> f64 {
    -e.device.mechanics.friction.level_nm[0] * m.velocity.signum()
}

/// How many times the friction a guess makes of it.
fn times(more: f64) -> f64 {
    (1.0 + more).max(0.1)
}

/// A friction that rises along the way, that is least or most somewhere, or that comes and goes with the turns of something
/// that is not round.
fn position_dependent(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let s = e.scales;
    let reach = s.position[0].abs().max(s.position[1].abs());
    let guess = regress(e, |m| {
        let friction = sliding_nm(e, m);
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
            log(2, times(more)),
        ]
    });
    let bent = [(0.4, 0.0), (-0.4, 0.0), (0.0, 0.8)].map(|(slope, curve)| {
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
            let friction = sliding_nm(e, m);
            let (sin, cos) = (wave_number * m.position).sin_cos();
            [friction * sin, friction * (cos - 1.0), friction]
        });
        let [sine, cosine, more] = found?;
        let free = vec![
            log(2, times(more)),
            linear(3, sine, 0.3),
            linear(4, cosine, 0.3),
            linear(5, wave_number, 0.2 * wave_number.min(coarse)),
        ];
        Some(term(kind, free, &[(0, 0.0), (1, 0.0)]))
    };
    let resistance = moments(e).map(|m| {
        let resisting_nm = -m.missing_nm * m.velocity.signum();
        (m.position, m.velocity > 0.0, resisting_nm)
    });
    let fine = waves::strongest(resistance.collect(), s.wave_numbers(), s.span()).into_iter();
    let fine = fine.map(|(wave_number, _)| wave_number);
    let fine = fine.filter(|wave_number| *wave_number > coarse);
    let ripples = RIPPLES.into_iter().map(|turns| turns * turn);
    let ripples = ripples.chain(fine.take(FINE_RIPPLES)).filter_map(ripple);
    terms(kind, guess, [])
        .into_iter()
        .chain(ripples)
        .chain(spot(kind, e))
        .chain(terms(kind, None, bent))
        .collect()
}

/// Bristles that bend by a share of the span of the motion, and what they lose by sliding or by bending.
fn bristles(kind: &'static Kind, e: &Evidence<'_>, bend: f64) -> [Term; 2] {
    let inertia = e.device.mechanics.inertia;
    let level = e.device.mechanics.friction.highest_nm();
    // Bristles that ring faster than samples follow are stick.
    let stiffest = inertia * (RESOLVED_RATE / e.scales.period_s.max(FINE_PERIOD_S)).powi(2);
    let distance = (bend * e.scales.span()).max(level / stiffest);
    let much = BRISTLE_DAMPING * 2.0 * (level / distance * inertia).sqrt();
    // They may not damp at all.
    let damping = guessed(1, much, 0.0);
    [log(2, 0.7), linear(3, 0.4, 0.2)]
        .map(|last| term(kind, vec![log(0, distance), damping, last], &[]))
}

/// A spot that rubs, where one explains most.
fn spot(kind: &'static Kind, e: &Evidence<'_>) -> Option<Term> {
    let [low, high] = e.scales.position;
    let places = (0..SPOT_PLACES).map(|k| (k as f64 + 0.5) / SPOT_PLACES as f64);
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
            let friction = sliding_nm(e, m);
            [friction * shape.at(m.position), friction]
        });
        let ([height, more], explained) = found?;
        let free = vec![
            log(2, times(more)),
            guessed(SPOT, height, 0.3),
            linear(7, position, width),
            log(8, width),
        ];
        Some((explained, term(kind, free, &[(0, 0.0), (1, 0.0)])))
    });
    most_telling(tried)
}

/// The term that explains most, (N m)².
fn most_telling(tried: impl Iterator<Item = (f64, Term)>) -> Option<Term> {
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, term)| term)
}

/// A friction that grows or falls all the time, that settles as something warms up, or that steps: over the session, or in every run
/// where the clock starts anew. One run cannot tell; what it shows is then taken for what every run will show, so that no
/// other is predicted from beyond what was seen.
fn drifts(kind: &'static Kind, e: &Evidence<'_>) -> Vec<Term> {
    let starts = e.series.iter().map(|series| series.session(0));
    let start_s = starts.min_by(f64::total_cmp).unwrap_or(0.0);
    let session = drifts_since(kind, e, |m| m.session_s - start_s);
    if e.series.iter().all(|series| series.run == e.series[0].run) {
        return session.into_iter().map(anew).collect();
    }
    let starts_anew = e.series.iter().any(|series| series.session_offset_s != 0.0);
    let runs = starts_anew.then(|| drifts_since(kind, e, |m| m.run_s));
    let runs = runs.into_iter().flatten().map(anew);
    session.into_iter().chain(runs).collect()
}

/// The same drift in every run whose clock starts anew.
fn anew(drift: Term) -> Term {
    drift.begun(&[(ANEW, 1.0)])
}

fn drifts_since(
    kind: &'static Kind,
    e: &Evidence<'_>,
    since_s: impl Fn(&Moment) -> f64,
) -> Vec<Term> {
    let duration_s = e.scales.duration_s;
    // Another level is an effect of its own, but must not bend the drift.
    let guess = regress(e, |m| {
        let friction = sliding_nm(e, m);
        [friction * since_s(m), friction]
    });
    let guess = guess.map(|[rate, _]| vec![guessed(0, rate, 0.3 / duration_s)]);
    let settling = |share: f64| {
        let settling_s = share * duration_s;
        let found = regress(e, |m| {
            let friction = sliding_nm(e, m);
            [friction * -(-since_s(m) / settling_s).exp_m1(), friction]
        });
        let [all, _] = found?;
        let free = vec![
            linear(0, all / settling_s, 0.5 / settling_s),
            log(1, settling_s),
        ];
        Some([0.0, 1.0].map(|settled| term(kind, free.clone(), &[(SETTLED, settled)])))
    };
    let settling = SETTLINGS.into_iter().filter_map(settling).flatten();
    let steady = |f: f64| vec![linear(0, f / duration_s, 0.5 / duration_s)];
    let steady = terms(kind, guess, [0.3, -0.3].map(steady));
    let stepping = step(kind, e, &since_s);
    steady.into_iter().chain(settling).chain(stepping).collect()
}

/// Another level from an instant on, where one explains most.
fn step(kind: &'static Kind, e: &Evidence<'_>, since_s: impl Fn(&Moment) -> f64) -> Option<Term> {
    let apart_s = e.scales.duration_s / STEPS as f64;
    let instants = (1..STEPS).map(|k| k as f64 * apart_s);
    let tried = instants.filter_map(|at_s| {
        let found = regress_in(moments(e), |m| {
            let friction = sliding_nm(e, m);
            [friction * f64::from(since_s(m) >= at_s), friction]
        });
        let ([step, _], explained) = found?;
        let free = vec![linear(STEP, step, 0.3), linear(STEP_AT, at_s, apart_s)];
        Some((explained, term(kind, free, &[(0, 0.0)])))
    });
    most_telling(tried)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::windows::motion::Motion;

    /// What is said of static friction where so much was held, N m, while the joint was accelerated so.
    fn told(held: &[(f64, f64)]) -> Option<f64> {
        let hold = |motions: &mut [Motion]| {
            for motion in motions.iter_mut() {
                motion.held_nm.fill(f64::NAN);
            }
            for (i, (held_nm, acceleration)) in held.iter().enumerate() {
                motions[0].held_nm[i] = *held_nm;
                motions[0].acceleration[i] = *acceleration;
            }
        };
        made::seen(&[], hold, held_rise)
    }

    #[test]
    fn a_friction_that_comes_and_goes_many_times_is_looked_for_where_it_does() {
        const WAVE_NUMBER: f64 = 40.0;
        let kind = host_sim::effects::kind("position_dependent_coulomb").unwrap();
        let rippled = format!("{}:ripple_sine=0.8,wave_number={WAVE_NUMBER}", kind.name);
        let near = |e: &Evidence<'_>| {
            let turn = TAU / e.scales.span();
            assert!(WAVE_NUMBER > 2.0 * RIPPLES[2] * turn);
            let starts = position_dependent(kind, e).into_iter();
            let fine = starts.filter(|start| start.values[3] > 0.4);
            let mut off = fine.map(|start| (start.values[5] - WAVE_NUMBER).abs());
            off.any(|off| off < 0.3 * turn)
        };
        assert!(made::seen(&[&rippled], |_| (), near));
    }

    #[test]
    fn rests_tell_how_much_static_friction_there_is_at_least() {
        let level = made::recording(&[]).model.coulomb;
        assert_eq!(told(&[]), None);
        assert_eq!(told(&[(0.9 * level, 0.0)]), None);
        let rise = told(&[(1.6 * level, 0.0), (-1.6 * level, 0.0), (0.2 * level, 0.0)]).unwrap();
        assert!((rise + 1.0 - 1.6 * HELD_MARGIN).abs() < 1e-9, "{rise}");
        // Where it turns, more than friction holds.
        assert_eq!(told(&[(0.9 * level, 0.0), (3.0 * level, 50.0)]), None);
    }
}
