//! Detects an input column that is constant although something drives the device.

use recording::{Recording, Run};

/// Least speed of the second half of a run, over that of the first, for a motion that does not decay. A passive oscillation decays more
/// within a few periods.
const LEAST_SPEED_RATIO: f64 = 0.7;
/// Least number of reversals of the velocity for a decision.
const FEWEST_REVERSALS: usize = 4;

/// True if the input of every run is constant and not zero, and the motion keeps oscillating. Under a constant torque a device comes to
/// rest, so such a column is not the real input. A zero input is allowed: the motor is off.
pub(crate) fn frozen_input(recording: &Recording) -> bool {
    !recording.runs.is_empty() && recording.runs.iter().all(is_frozen)
}

fn is_frozen(run: &Run) -> bool {
    let Some(&first) = run.input.first() else {
        return false;
    };
    first != 0.0 && run.input.iter().all(|input| *input == first) && keeps_moving(run)
}

/// True if the motion reverses and keeps its speed. The steps span a fiftieth of the run, so that noise does not count as motion.
fn keeps_moving(run: &Run) -> bool {
    let step = (run.position.len() / 50).max(1);
    let coarse: Vec<f64> = run.position.iter().copied().step_by(step).collect();
    let moves: Vec<f64> = coarse.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let reversals = moves.windows(2).filter(|pair| pair[0] * pair[1] < 0.0);
    let (first_half, second_half) = moves.split_at(moves.len() / 2);
    let speed = |moves: &[f64]| moves.iter().map(|m| m * m).sum::<f64>().sqrt();
    reversals.count() >= FEWEST_REVERSALS
        && speed(second_half) >= LEAST_SPEED_RATIO * speed(first_half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    fn is_frozen_with(input: f64, damping: f64) -> bool {
        let mut recording = made::recording(&[]);
        for run in &mut recording.runs {
            let start_s = run.time[0];
            run.input = vec![input; run.time.len()];
            let position = |t: &f64| (-damping * (t - start_s)).exp() * (9.0 * t).sin();
            run.position = run.time.iter().map(position).collect();
        }
        frozen_input(&recording)
    }

    #[test]
    fn a_lasting_oscillation_under_a_constant_input_shows_a_frozen_column() {
        assert!(is_frozen_with(-9.5e-4, 0.0));
        assert!(!is_frozen_with(-9.5e-4, 0.8), "a swing that dies away");
        assert!(!is_frozen_with(0.0, 0.0), "a motor that is off");
    }
}
