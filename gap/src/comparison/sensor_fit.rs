//! Fits each sensing effect to the difference between two position columns.

use crate::columns::{Columns, Disagreement};
use crate::effects::{self, Identification};
use host_sim::effects::Kind;

/// Share of the squares closed by the best effect within which an effect with fewer parameters is preferred.
pub(super) const PARSIMONY: f64 = 0.01;

/// The fit of a sensing effect to the disagreement.
#[derive(Clone, Debug)]
pub(super) struct SensorFit {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
    /// Mean squared residual, in position units squared.
    pub left: f64,
    parameters: usize,
}

/// The fits of all sensing effects. The preferred one comes first.
pub(super) fn sensor_fits(columns: &Columns) -> Vec<SensorFit> {
    let disagreement = Disagreement::of(columns);
    let mut all: Vec<SensorFit> = effects::sensing()
        .flat_map(|effect| {
            let fits = effect.column_fits(&disagreement).into_iter();
            fits.map(move |values| (effect, values))
        })
        .map(|(effect, values)| sensor_fit(&disagreement, effect, values))
        .collect();
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    let Some(best) = all.first().map(|first| first.left) else {
        return all;
    };
    let close = best + PARSIMONY * (disagreement.before() - best).max(0.0);
    let preferred = (0..all.len())
        .filter(|&i| all[i].left <= close)
        .min_by_key(|&i| (all[i].parameters, i));
    if let Some(preferred) = preferred {
        let first = all.remove(preferred);
        all.insert(0, first);
    }
    all
}

fn sensor_fit(
    disagreement: &Disagreement<'_>,
    effect: &'static dyn Identification,
    values: Vec<f64>,
) -> SensorFit {
    let kind = effect.kind();
    SensorFit {
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

    /// Name of the preferred effect for a column that exceeds a slow sine by `more`, a function of the time from 0 to 1.
    fn preferred(more: impl Fn(f64) -> f64) -> &'static str {
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
        sensor_fits(&columns)[0].kind.name
    }

    #[test]
    fn a_difference_that_needs_many_jumps_is_no_lost_count() {
        let jump = |t: f64| if t < 0.3 { 0.0 } else { 0.5 };
        assert_eq!(preferred(jump), "lost_counts");
        // A gain and a lag together.
        let gain_and_lag = |t: f64| -0.4 * (TAU * t).sin() - 0.4 * (TAU * t).cos();
        assert_ne!(preferred(gain_and_lag), "lost_counts");
    }
}
