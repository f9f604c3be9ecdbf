//! Whether the columns mean what they are taken for: a wrong sign or unit is no effect, and a controller's output no excitation.

mod frozen;
mod law;
mod meant;
pub(crate) mod timing;

pub(crate) use frozen::frozen_input;
pub use meant::UnitMistake;

use meant::{Meant, Turn, meant};
use recording::{Drive, Model, Oddity, Recording};

/// Share of what is quick in an input that the noise of the position explains from which on it is a controller's. Of 1106 open
/// loops none comes above 0.7; of as many closed ones half do.
const LEAST_OF_LAW: f64 = 0.8;

/// The recording, a run as closed-loop if its input is a controller's, and its model turned round if `input` and `position` go
/// against each other, with oddities that say so.
///
/// The model then leaves far less, in most windows, and less than without any input.
///
/// # Errors
/// [`UnitMistake`] if it does so with a column in another unit.
pub fn inspected(mut recording: Recording) -> Result<Recording, UnitMistake> {
    for run in &mut recording.runs {
        if run.drive == Drive::OpenLoop
            && let Some(share) = law::share_of_law(run).filter(|share| *share > LEAST_OF_LAW)
        {
            run.drive = Drive::ClosedLoop;
            recording.oddities.push(Oddity::Controlled {
                file: run.file.clone(),
                percent: 100.0 * share,
            });
        }
    }
    match meant(&recording) {
        None => {}
        Some(Meant::Turned(turn, oddity)) => {
            turn_models(&mut recording, turn);
            recording.oddities.push(oddity);
        }
        Some(Meant::Scaled(mistake)) => return Err(mistake),
    }
    Ok(recording)
}

/// Turns the model, and the numbers that runs state of their own.
fn turn_models(recording: &mut Recording, turn: Turn) {
    let turned = recording
        .runs
        .iter()
        .map(|run| turn(recording.model_of(run)));
    let turned: Vec<Model> = turned.collect();
    recording.model = turn(recording.model);
    for (run, model) in recording.runs.iter_mut().zip(turned) {
        for (name, value) in &mut run.numbers {
            *value = model.get(name).unwrap_or(*value);
        }
    }
}
