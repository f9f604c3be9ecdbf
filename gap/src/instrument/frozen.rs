//! An input column that repeats one value while something drives the device.

use recording::{Recording, Run};

/// Share of the speed of the first half of a run that the second half keeps at least where the motion does not die away. A passive
/// device that rings keeps less after a few periods.
const KEPT: f64 = 0.7;
/// Reversals of the velocity without which a run says nothing of that.
const FEWEST_REVERSALS: usize = 4;

/// True if every run repeats one input that is not zero, and the motion goes on to and fro all the same: under a constant torque a
/// device comes to rest, so that the column cannot be what it was told. An input of zero is that of a motor that is off.
pub(crate) fn frozen_input(recording: &Recording) -> bool {
    !recording.runs.is_empty() && recording.runs.iter().all(is_frozen)
}

fn is_frozen(run: &Run) -> bool {
    let Some(&first) = run.input.first() else {
        return false;
    };
    first != 0.0 && run.input.iter().all(|input| *input == first) && goes_on(run)
}

/// True if the motion reverses and keeps its speed. Steps are taken over a fiftieth of the run, longer than what noise stirs.
fn goes_on(run: &Run) -> bool {
    let step = (run.position.len() / 50).max(1);
    let coarse: Vec<f64> = run.position.iter().copied().step_by(step).collect();
    let moves: Vec<f64> = coarse.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let reversals = moves.windows(2).filter(|pair| pair[0] * pair[1] < 0.0);
    let (early, late) = moves.split_at(moves.len() / 2);
    let speed = |moves: &[f64]| moves.iter().map(|m| m * m).sum::<f64>().sqrt();
    reversals.count() >= FEWEST_REVERSALS && speed(late) >= KEPT * speed(early)
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
    fn a_motion_that_goes_on_under_one_input_is_driven_by_something_else() {
        assert!(is_frozen_with(-9.5e-4, 0.0));
        assert!(!is_frozen_with(-9.5e-4, 0.8), "a swing that dies away");
        assert!(!is_frozen_with(0.0, 0.0), "a motor that is off");
    }
}
