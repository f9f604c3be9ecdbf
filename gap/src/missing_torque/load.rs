//! Runs of one load.

use recording::Recording;
use std::borrow::Cow;

/// The runs whose load has the most rows, with the numbers of that load in `[model]`. A torque along runs of several loads is no one
/// law of the motion.
pub(super) fn of_one_load(recording: &Recording) -> Cow<'_, Recording> {
    let runs = &recording.runs;
    if runs.iter().all(|run| run.numbers.is_empty()) {
        return Cow::Borrowed(recording);
    }
    let rows_of = |of: &&recording::Run| -> usize {
        let alike = runs.iter().filter(|run| run.numbers == of.numbers);
        alike.map(recording::Run::len).sum()
    };
    let Some(most) = runs.iter().rev().max_by_key(rows_of) else {
        return Cow::Borrowed(recording);
    };
    let alike = runs.iter().filter(|run| run.numbers == most.numbers);
    let alike = alike.cloned().map(|run| recording::Run {
        numbers: [].into(),
        ..run
    });
    let mut one = recording.with_runs(alike.collect());
    one.model = recording.model_of(most);
    Cow::Owned(one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;

    #[test]
    fn the_load_with_the_most_rows_is_looked_at() {
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
