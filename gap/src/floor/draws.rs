//! What noise, quantising and restarts alone leave of a model that is right.

use super::replicate::Replicate;
use crate::predict::Predictor;
use crate::windows::series::{Series, Window};
use rayon::prelude::*;
use recording::Recording;
use std::collections::HashMap;

/// Windows that are looked at, or all there are: where noise decides between stick and slip, a few of them are most of the
/// floor, and from so many it is known to some 20 %.
pub(crate) const LOOKED_AT: usize = 400;
/// Factor within which it is known then.
pub(crate) const FLOOR_DOUBT: f64 = 1.2;

/// Squares that noise and restarts alone would leave in each of some windows, given with their runs, if `predictor` were right:
/// the mean over some draws of the noise, as near stick and slip, and where a restart falls on a kink of the motion, nothing is
/// linear, until about so many windows are `looked_at`. The windows are those of series that were `cut` from the recording.
pub(crate) fn floor_squares<'a>(
    recording: &Recording,
    predictor: &Predictor,
    windows: impl Iterator<Item = (usize, &'a Window)>,
    cut: fn(&Recording, f64) -> Vec<Series>,
    looked_at: usize,
) -> Vec<f64> {
    let both = Replicate::both(recording, predictor);
    let there: usize = both.iter().map(Replicate::telling).sum();
    let draws = looked_at.div_ceil(there.max(1)).next_multiple_of(2) as u64;
    let draws = both
        .iter()
        .flat_map(|one| (0..draws).map(move |draw| (one, draw)));
    let draws: Vec<_> = draws.collect();
    let left = draws
        .into_par_iter()
        .map(|(replicate, draw)| left(replicate, draw, predictor, cut));
    let left: Vec<Vec<(Place, Left)>> = left.collect();
    let mut by_window: HashMap<Place, Left> = HashMap::new();
    let mut all = Left::default();
    for (place, one) in left.iter().flatten() {
        all.add(one);
        by_window.entry(*place).or_default().add(one);
    }
    let floors = windows.map(|(run, window)| {
        let start_s = recording.runs[run].time[0];
        let index = ((window.restart.time_s - start_s) / recording.horizon).round() as usize;
        let one = by_window.get(&[run, index]).unwrap_or(&all);
        one.squares / one.samples.max(1) as f64 * window.samples.len() as f64
    });
    floors.collect()
}

/// A run, and a window of it.
type Place = [usize; 2];

/// What is left of so many samples.
#[derive(Clone, Copy, Default)]
struct Left {
    squares: f64,
    samples: usize,
}

impl Left {
    fn add(&mut self, other: &Self) {
        self.squares += other.squares;
        self.samples += other.samples;
    }
}

/// Of each window that tells, in one draw.
fn left(
    replicate: &Replicate<'_>,
    draw: u64,
    predictor: &Predictor,
    cut: fn(&Recording, f64) -> Vec<Series>,
) -> Vec<(Place, Left)> {
    let (_, shown) = replicate.shown(draw, cut);
    let mut all = Vec::new();
    for series in shown {
        let predicted = predictor.predict(&series);
        let windows = series.windows.iter().enumerate();
        all.extend(
            windows
                .filter(|(w, _)| replicate.tells(*w))
                .map(|(w, window)| {
                    let left = Left {
                        squares: series.squares(window, &predicted),
                        samples: window.samples.len(),
                    };
                    ([series.run, w + replicate.skipped(series.run)], left)
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

    /// Root of what is left of the windows of some recordings by a model that has the effects that are `known`, over what the
    /// floor of them is.
    fn over_floor(effects: &[&str], known: &[&str]) -> f64 {
        let terms: Vec<Term> = known.iter().map(|effect| made::written(effect)).collect();
        let (mut left, mut floor) = (0.0, 0.0);
        for seed in 0..16 {
            let recording = made::recorded(effects, seed);
            let problem = made::problem(&recording);
            let terms = terms.clone();
            let fit = problem.fit(&Hypothesis { terms }, Vec::new(), Part::All, 0);
            left += problem.window_squares(&fit, Part::All).iter().sum::<f64>();
            floor += problem.floor_squares(&fit).iter().sum::<f64>();
        }
        (left / floor).sqrt()
    }

    #[test]
    fn a_right_model_leaves_the_floor_and_a_wrong_one_more() {
        let right = over_floor(&[], &[]);
        assert!((0.7..1.4).contains(&right), "{right}");
        let wrong = over_floor(&["spring:stiffness=0.06,zero=0"], &[]);
        assert!(wrong > 5.0, "{wrong}");
    }

    #[test]
    fn so_does_one_in_which_more_moves_than_the_sensor_sees() {
        let hidden = ["compliance:stiffness=0.5,damping=1e-4"];
        let right = over_floor(&hidden, &hidden);
        assert!((0.7..1.4).contains(&right), "{right}");
    }
}
