//! Selects the runs with one load.

use recording::Recording;
use std::borrow::Cow;

/// The runs with the load that has the most rows, with the parameters of that load in the model. The missing torque of runs with
/// different loads is not one function of the motion.
pub(super) fn of_one_load(recording: &Recording) -> Cow<'_, Recording> {
    let runs = &recording.runs;
    if runs.iter().all(|run| run.numbers.is_empty()) {
        return Cow::Borrowed(recording);
    }
    let rows_of = |of: &&recording::Run| -> usize {
        let with_load = runs.iter().filter(|run| run.numbers == of.numbers);
        with_load.map(recording::Run::len).sum()
    };
    let Some(most) = runs.iter().rev().max_by_key(rows_of) else {
        return Cow::Borrowed(recording);
    };
    let with_load = runs.iter().filter(|run| run.numbers == most.numbers);
    let with_load = with_load.cloned().map(|run| recording::Run {
        numbers: [].into(),
        ..run
    });
    let mut one = recording.with_runs(with_load.collect());
    one.model = recording.model_of(most);
    Cow::Owned(one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn the_runs_of_the_load_with_the_most_rows_are_selected() {
        let mut recording = made::recording(&[]);
        assert_eq!(*of_one_load(&recording), recording);
        let heavy = 3.0 * recording.model.inertia;
        let longest = recording.runs.iter().map(recording::Run::len).max();
        for run in &mut recording.runs {
            if Some(run.len()) == longest {
                run.numbers.insert("inertia".to_owned(), heavy);
            }
        }
        let one = of_one_load(&recording);
        let rows = |of: &Recording| of.runs.iter().map(recording::Run::len).sum::<usize>();
        assert!(rows(&one) * 2 >= rows(&recording));
        assert!(one.runs.iter().all(|run| run.numbers.is_empty()));
    }
}
