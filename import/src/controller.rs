//! Reconstructs the command of a controller that was not logged, from its inputs.

use crate::ticks::Ticks;

/// Gains of a PID law: input per unit of the logged position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gains {
    pub kp: f64,
    pub ki: f64,
    pub kd: f64,
}

/// The PID law on the logged position, from tick `on`. It uses the error, the sum of the errors, and the rate of the
/// position at the last tick. The result is limited to ± `limit`.
pub(crate) fn command(
    seen: &[f64],
    setpoint: &[f64],
    gains: Gains,
    limit: Option<f64>,
    tick_s: f64,
    on: usize,
) -> Vec<f64> {
    let mut sum = 0.0;
    let mut command = vec![0.0; seen.len()];
    for tick in on..seen.len() {
        let error = setpoint[tick] - seen[tick];
        sum += error * tick_s;
        let before = seen[tick.saturating_sub(1)];
        let rate = (seen[tick] - before) / tick_s;
        let asked = gains.kp * error + gains.ki * sum - gains.kd * rate;
        let limit = limit.unwrap_or(f64::INFINITY);
        command[tick] = asked.clamp(-limit, limit);
    }
    command
}

/// Number of ticks before the first motion in which the controller may have been switched on.
const EARLIER: usize = 80;
/// Share of the step over which the first acceleration is fitted.
const FOLLOWED: f64 = 0.15;
/// Share of the step at which the motion starts.
const MOVES: f64 = 0.02;

/// The tick at which a controller was switched on, for a step of the position. At this tick, the first part of the motion
/// fits best to an acceleration proportional to the command minus dry friction. Both factors are free. `None` if nothing
/// moves.
#[expect(clippy::cast_precision_loss, reason = "counts of rows")]
pub(crate) fn switched_on(
    ticks: &Ticks,
    position: &[f64],
    command_from: impl Fn(usize) -> Vec<f64>,
) -> Option<usize> {
    let tail = position.len() / 10;
    let last = position[position.len().checked_sub(tail.max(1))?..]
        .iter()
        .sum::<f64>()
        / tail.max(1) as f64;
    let step = last - position.first()?;
    if step == 0.0 {
        return None;
    }
    let away = |share: f64, rest: f64| position.iter().position(|x| (x - rest) / step > share);
    let moves = away(MOVES, position[0])?;
    let earliest = ticks.of_row[moves].saturating_sub(EARLIER);
    let first = ticks
        .of_row
        .partition_point(|tick| *tick < earliest)
        .saturating_sub(20);
    let resting = &position[first
        ..ticks
            .of_row
            .partition_point(|tick| *tick <= earliest)
            .max(first + 1)];
    let rest = resting.iter().sum::<f64>() / resting.len() as f64;
    let end = away(FOLLOWED, rest)?.max(moves + 2);
    let rows = first..end.min(position.len());
    let left = |on: usize| {
        let command = command_from(on);
        let (mut speed, mut way) = (0.0, 0.0);
        let mut ways = vec![0.0; command.len()];
        for tick in on..ticks.of_row[rows.end - 1] {
            // The command is constant until the next tick.
            way += speed + command[tick] / 2.0;
            speed += command[tick];
            ways[tick + 1] = way;
        }
        let points = rows.clone().map(|row| {
            let tick = ticks.of_row[row];
            let passed = tick.saturating_sub(on) as f64;
            Point {
                driven: ways[tick],
                slowed: -passed * passed / 2.0 * step.signum(),
                moved: position[row] - rest,
            }
        });
        left_over(&points.collect::<Vec<_>>())
    };
    let candidates = (earliest..=ticks.of_row[moves]).map(|on| (left(on), on));
    candidates
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, on)| on)
}

/// A row of the first motion.
struct Point {
    /// Distance due to the command only, for one unit of acceleration per unit of command.
    driven: f64,
    /// Distance due to friction only, for one unit of deceleration.
    slowed: f64,
    /// Measured distance.
    moved: f64,
}

/// Least sum of squared residuals of the measured distance for any combination of both. Friction can only decelerate.
fn left_over(points: &[Point]) -> f64 {
    let sum = |term: &dyn Fn(&Point) -> f64| points.iter().map(term).sum::<f64>();
    let (dd, ss, ds) = (
        sum(&|p| p.driven * p.driven),
        sum(&|p| p.slowed * p.slowed),
        sum(&|p| p.driven * p.slowed),
    );
    let (dm, sm) = (sum(&|p| p.driven * p.moved), sum(&|p| p.slowed * p.moved));
    let determinant = dd * ss - ds * ds;
    let alone = (if dd > 0.0 { dm / dd } else { 0.0 }, 0.0);
    // Below this relative determinant, the two distances are proportional and cannot be separated.
    const ALIKE: f64 = 1e-9;
    let (drive, friction) = if determinant > ALIKE * dd * ss {
        let both = (
            (dm * ss - sm * ds) / determinant,
            (sm * dd - dm * ds) / determinant,
        );
        if both.1 > 0.0 { both } else { alone }
    } else {
        alone
    };
    sum(&|p| (p.moved - drive * p.driven - friction * p.slowed).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Period of the loop, s.
    const TICK_S: f64 = 3.5e-4;
    const GAIN: f64 = 0.22;
    const ON: usize = 1003;

    /// Response of a paddle with dry friction to a step of 10 degrees: the filtered angle at each tick, deg.
    fn seen(gains: Gains, friction_nm: f64) -> Vec<f64> {
        const INERTIA: f64 = 5.8e-4;
        const PARTS: i32 = 20;
        let part_s = TICK_S / f64::from(PARTS);
        let (mut x, mut v, mut filtered) = (0.0_f64, 0.0_f64, 0.0);
        let mut seen = Vec::new();
        for tick in 0..2600 {
            let before = filtered;
            filtered += GAIN * (x.to_degrees() - filtered);
            seen.push(filtered);
            let rate = (filtered - before) / TICK_S;
            let asked = gains.kp * (10.0 - filtered) - gains.kd * rate;
            let torque = if tick < ON {
                0.0
            } else {
                15.0 * asked.clamp(-0.0323, 0.0323)
            };
            for _ in 0..PARTS {
                let free = v + torque / INERTIA * part_s;
                let slowed = friction_nm / INERTIA * part_s;
                v = if free.abs() <= slowed {
                    0.0
                } else {
                    free - slowed.copysign(free)
                };
                x += v * part_s;
            }
        }
        seen
    }

    #[test]
    fn the_tick_of_switching_on_is_found_for_any_friction() {
        // Rows are two or three ticks apart.
        let rows: Vec<usize> = (0..1000)
            .scan(0, |at, k: usize| {
                *at += 2 + usize::from(!k.is_multiple_of(4));
                Some(*at)
            })
            .take_while(|tick| *tick < 2600)
            .collect();
        for (kp, kd) in [(0.01, 3e-4), (0.05, 3e-4), (0.05, 8e-4)] {
            for friction_nm in [0.0, 0.005, 0.015] {
                let gains = Gains {
                    kp: kp / 15.0,
                    ki: 0.0,
                    kd: kd / 15.0,
                };
                let filtered = seen(gains, friction_nm);
                let time: Vec<f64> = rows.iter().map(|tick| *tick as f64 * TICK_S).collect();
                let logged: Vec<f64> = rows.iter().map(|tick| filtered[*tick]).collect();
                let ticks = Ticks::of(&time, TICK_S);
                let position = ticks.without_low_pass(&logged, GAIN);
                let between = ticks.between(&logged);
                let setpoint = vec![10.0; between.len()];
                let command = |on| command(&between, &setpoint, gains, Some(0.0323), TICK_S, on);
                let found = switched_on(&ticks, &position, command).map(|on| on + rows[0]);
                assert_eq!(
                    found,
                    Some(ON),
                    "kp {kp}, kd {kd}, friction {friction_nm} N m"
                );
            }
        }
    }
}
