//! Inspects the columns of a recording. A wrong sign or unit is not an effect, and the output of a controller is not an open-loop
//! excitation.

mod frozen;
mod law;
mod sign_or_unit;
pub(crate) mod timing;

pub(crate) use frozen::frozen_input;
pub use sign_or_unit::UnitMistake;

use recording::{Drive, Model, Oddity, Recording};
use sign_or_unit::{SignOrUnit, Turn, sign_or_unit};

/// Least share of the fast changes of an input that the noise of the position explains for the input to be the output of a controller.
const LEAST_OF_LAW: f64 = 0.8;

/// Inspects a recording. A run becomes closed-loop if its input is the output of a controller. The model changes its sign if `input` and
/// `position` have opposite signs: if with it the residual is far smaller, smaller in most windows, and smaller than without any input.
/// Each change is added to the oddities.
///
/// # Errors
///
/// [`UnitMistake`] if a column has another unit by the same criterion.
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
    match sign_or_unit(&recording) {
        None => {}
        Some(SignOrUnit::OppositeSign(turn, oddity)) => {
            turn_models(&mut recording, turn);
            recording.oddities.push(oddity);
        }
        Some(SignOrUnit::Scaled(mistake)) => return Err(mistake),
    }
    Ok(recording)
}

/// Changes the sign of the model, and of the parameters that runs state on their own.
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
