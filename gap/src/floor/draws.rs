//! The floor: the squared residuals of an exact model, which noise, quantization and restarts cause.

use super::replicate::Replicate;
use crate::predict::Predictor;
use crate::windows::series::{Series, Window};
use rayon::prelude::*;
use recording::Recording;
use std::collections::HashMap;

/// Number of windows from which the floor is estimated, or all windows if there are fewer. Where noise decides between stick and slip, a
/// few windows hold most of the floor; from this number it is accurate to about 20 %.
pub(crate) const SAMPLED_WINDOWS: usize = 400;
/// Factor within which the floor of [`SAMPLED_WINDOWS`] windows is accurate.
pub(crate) const FLOOR_DOUBT: f64 = 1.2;

/// Expected sum of squared residuals in each of `windows` if the model of `predictor` were exact, by parametric bootstrap. Each window
/// comes with the index of its run.
///
/// The result is the mean over several draws of the noise, about `sampled_windows` windows in all. Propagation of the variance would not
/// do: near stick and slip, and for a restart at a kink of the motion, the residuals are not linear in the noise. The function `cut` must
/// be the one that cut the windows from the recording.
pub(crate) fn floor_squares<'a>(
    recording: &Recording,
    predictor: &Predictor,
    windows: impl Iterator<Item = (usize, &'a Window)>,
    cut: fn(&Recording, f64) -> Vec<Series>,
    sampled_windows: usize,
) -> Vec<f64> {
    let both = Replicate::both(recording, predictor);
    let evaluated: usize = both.iter().map(Replicate::evaluated_count).sum();
    let draws = sampled_windows
        .div_ceil(evaluated.max(1))
        .next_multiple_of(2) as u64;
    let draws = both
        .iter()
        .flat_map(|one| (0..draws).map(move |draw| (one, draw)));
    let draws: Vec<_> = draws.collect();
    let residuals = draws
        .into_par_iter()
        .map(|(replicate, draw)| residuals(replicate, draw, predictor, cut));
    let residuals: Vec<Vec<(WindowIndex, Residuals)>> = residuals.collect();
    let mut by_window: HashMap<WindowIndex, Residuals> = HashMap::new();
    let mut all = Residuals::default();
    for (window_index, one) in residuals.iter().flatten() {
        all.add(one);
        by_window.entry(*window_index).or_default().add(one);
    }
    let floors = windows.map(|(run, window)| {
        let start_s = recording.runs[run].time[0];
        let index = ((window.restart.time_s - start_s) / recording.horizon).round() as usize;
        let one = by_window.get(&[run, index]).unwrap_or(&all);
        one.squares / one.samples.max(1) as f64 * window.samples.len() as f64
    });
    floors.collect()
}

/// Index of a run and of a window in it.
type WindowIndex = [usize; 2];

/// Sum of squared residuals over a number of samples.
#[derive(Clone, Copy, Default)]
struct Residuals {
    squares: f64,
    samples: usize,
}

impl Residuals {
    fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.samples += other.samples;
    }
}

/// Squared residuals of each evaluated window in one draw.
fn residuals(
    replicate: &Replicate<'_>,
    draw: u64,
    predictor: &Predictor,
    cut: fn(&Recording, f64) -> Vec<Series>,
) -> Vec<(WindowIndex, Residuals)> {
    let (_, observed) = replicate.observed(draw, cut);
    let mut all = Vec::new();
    for series in observed {
        let predicted = predictor.predict(&series);
        let windows = series.windows.iter().enumerate();
        all.extend(
            windows
                .filter(|(w, _)| replicate.is_evaluated(*w))
                .map(|(w, window)| {
                    let residuals = Residuals {
                        squares: series.squares(window, &predicted),
                        samples: window.samples.len(),
                    };
                    ([series.run, w + replicate.skipped(series.run)], residuals)
                }),
        );
    }
    all
}

#[cfg(test)]
mod tests {
    use crate::fit::hypothesis::Hypothesis;
    use crate::fit::part::Part;
    use crate::made;
    use crate::term::Term;

    /// Rms residual of a model with the effects `known`, over the floor, for recordings with the effects `effects`.
    fn over_floor(effects: &[&str], known: &[&str]) -> f64 {
        let terms: Vec<Term> = known.iter().map(|effect| made::written(effect)).collect();
        let (mut residuals, mut floor) = (0.0, 0.0);
        for seed in 0..16 {
            let recording = made::recorded(effects, seed);
            let problem = made::problem(&recording);
            let terms = terms.clone();
            let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
            residuals += problem.window_squares(&fit, Part::All).iter().sum::<f64>();
            floor += problem.floor_squares(&fit).iter().sum::<f64>();
        }
        (residuals / floor).sqrt()
    }

    #[test]
    fn an_exact_model_reaches_the_floor_and_a_wrong_one_does_not() {
        let right = over_floor(&[], &[]);
        assert!((0.7..1.4).contains(&right), "{right}");
        let wrong = over_floor(&["spring:stiffness=0.06,zero=0"], &[]);
        assert!(wrong > 5.0, "{wrong}");
    }

    #[test]
    fn an_exact_model_with_an_unobserved_mass_reaches_the_floor() {
        let hidden = ["compliance:stiffness=0.5,damping=1e-4"];
        let right = over_floor(&hidden, &hidden);
        assert!((0.7..1.4).contains(&right), "{right}");
    }
}
