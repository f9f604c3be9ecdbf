//! The command of a controller that was not logged, made anew from what it saw.

use crate::ticks::Ticks;

/// Gains of a PID law: input per unit of the position as logged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gains {
    pub kp: f64,
    pub ki: f64,
    pub kd: f64,
}

/// The law on the logged position, from the tick `on` on: proportional to the error, to its sum, and against the
/// position's rate of the last tick; clipped at ± `limit`.
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

/// Ticks before the position first moves in which the controller may have been switched on.
const EARLIER: usize = 80;
/// Share of the step that the first acceleration is followed over.
const FOLLOWED: f64 = 0.15;
/// Share of the step from which the position moves.
const MOVES: f64 = 0.02;

/// The tick at which a controller was switched on that then moves the position by a step: that for which the first part of
/// the motion follows an acceleration in proportion to the command best, whatever the proportion. `None` if nothing moves.
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
            // The command is held until the next tick.
            way += speed + command[tick] / 2.0;
            speed += command[tick];
            ways[tick + 1] = way;
        }
        let pairs = rows
            .clone()
            .map(|row| (ways[ticks.of_row[row]], position[row] - rest));
        let (along, square) = pairs
            .clone()
            .fold((0.0, 0.0), |(a, s), (w, x)| (a + w * x, s + w * w));
        let factor = if square > 0.0 { along / square } else { 0.0 };
        pairs.map(|(w, x)| (x - factor * w).powi(2)).sum::<f64>()
    };
    let candidates = (earliest..=ticks.of_row[moves]).map(|on| (left(on), on));
    candidates
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, on)| on)
}
