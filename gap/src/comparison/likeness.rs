//! The sensing effect that turns one column into the other.

use crate::columns::{Columns, Disagreement};
use crate::effects::{self, Identification};
use host_sim::effects::Kind;

/// Within this share of what the best one closes, fewer parameters win.
pub(super) const PARSIMONY: f64 = 0.01;

/// What a sensing effect leaves of the disagreement.
#[derive(Clone, Debug)]
pub(super) struct Likeness {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
    /// Mean square.
    pub left: f64,
    parameters: usize,
}

/// What all sensing effects leave, the likeliest first.
pub(super) fn likenesses(columns: &Columns) -> Vec<Likeness> {
    let disagreement = Disagreement::of(columns);
    let mut all: Vec<Likeness> = effects::sensing()
        .flat_map(|effect| {
            let fits = effect.column_fits(&disagreement).into_iter();
            fits.map(move |values| (effect, values))
        })
        .map(|(effect, values)| likeness(&disagreement, effect, values))
        .collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    let Some(best) = all.first().map(|first| first.left) else {
        return all;
    };
    let close = best + PARSIMONY * (disagreement.before() - best).max(0.0);
    let likeliest = (0..all.len())
        .filter(|&i| all[i].left <= close)
        .min_by_key(|&i| (all[i].parameters, i));
    if let Some(likeliest) = likeliest {
        let first = all.remove(likeliest);
        all.insert(0, first);
    }
    all
}

fn likeness(
    disagreement: &Disagreement<'_>,
    effect: &'static dyn Identification,
    values: Vec<f64>,
) -> Likeness {
    let kind = effect.kind();
    Likeness {
        kind,
        left: disagreement.left(kind, &values),
        parameters: effect.count_in_columns(&values),
        values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Track;
    use core::f64::consts::TAU;

    /// What is likeliest where a column shows so much more than a slow sine, as a function of time over its duration.
    fn likeliest(more: impl Fn(f64) -> f64) -> &'static str {
        const SAMPLES: usize = 1000;
        const STD: f64 = 1e-3;
        let session_s: Vec<f64> = (0..SAMPLES).map(|i| i as f64 / SAMPLES as f64).collect();
        let reference: Vec<f64> = session_s.iter().map(|t| (TAU * t).sin()).collect();
        let both = session_s.iter().zip(&reference);
        let track = Track {
            shown: both.map(|(t, x)| x + more(*t)).collect(),
            session_s,
            reference,
            windows: std::iter::once(0..SAMPLES).collect(),
        };
        let columns = Columns {
            tracks: vec![track],
            variance: STD * STD,
        };
        likenesses(&columns)[0].kind.name
    }

    #[test]
    fn what_takes_ever_more_jumps_is_none() {
        let jump = |t: f64| if t < 0.3 { 0.0 } else { 0.5 };
        assert_eq!(likeliest(jump), "lost_counts");
        // A gain and a lag.
        let late = |t: f64| -0.4 * (TAU * t).sin() - 0.4 * (TAU * t).cos();
        assert_ne!(likeliest(late), "lost_counts");
    }
}
