//! Fits pairs of sensing effects to the difference between two columns, for example a gain and a hysteresis.

use super::sensor_fit::PARSIMONY;
use crate::columns::{Columns, Disagreement, Track, mean_square, read, residuals};
use crate::effects::{self, Identification};
use host_sim::effects::Kind;

/// Number of alternating fits of the two effects.
const ROUNDS: usize = 3;

/// A sensing effect with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub kind: &'static Kind,
    pub values: Vec<f64>,
}

/// The two effects with the smallest residual, or with nearly the smallest and fewer parameters, and their mean squared residual. The
/// effect that acts first on the position comes first.
pub(super) fn two(columns: &Columns) -> Option<([Part; 2], f64)> {
    let pairs = effects::sensing().flat_map(|first| {
        let seconds = effects::sensing().filter(move |second| second.name() != first.name());
        let alone = best(first, columns);
        seconds.filter_map(move |second| alternating_fit(columns, alone.clone()?, first, second))
    });
    let mut pairs: Vec<([Part; 2], f64)> = pairs.collect();
    pairs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let best = pairs.first()?.1;
    let close = best + PARSIMONY * (Disagreement::of(columns).before() - best).max(0.0);
    let close = pairs
        .into_iter()
        .take_while(|(_, residual)| *residual <= close);
    close.min_by_key(|(parts, _)| parts.iter().map(Part::count).sum::<usize>())
}

/// Fits two effects alternately, each with the other fixed.
fn alternating_fit(
    columns: &Columns,
    mut first: Part,
    effect: &'static dyn Identification,
    second: &'static dyn Identification,
) -> Option<([Part; 2], f64)> {
    let mut found: Option<([Part; 2], f64)> = None;
    for _ in 0..ROUNDS {
        let behind_first = mapped(columns, |track| Track {
            reference: read(track, first.kind, &first.values),
            ..track.clone()
        });
        let other = best(second, &behind_first)?;
        let residual = residual(&behind_first, &other);
        if found.as_ref().is_none_or(|(_, least)| residual < *least) {
            found = Some(([first.clone(), other.clone()], residual));
        }
        // The part of the second effect is subtracted from the shown column, so that the first one is fitted to the rest.
        let without_second = mapped(columns, |track| {
            let seen = Track {
                reference: read(track, first.kind, &first.values),
                ..track.clone()
            };
            let added = read(&seen, other.kind, &other.values);
            let added = added.iter().zip(&seen.reference).map(|(y, x)| y - x);
            let shown = track.shown.iter().zip(added).map(|(y, more)| y - more);
            Track {
                shown: shown.collect(),
                ..track.clone()
            }
        });
        first = best(effect, &without_second)?;
    }
    found
}

/// An effect with the parameters of the smallest residual.
fn best(effect: &'static dyn Identification, columns: &Columns) -> Option<Part> {
    let disagreement = Disagreement::of(columns);
    let kind = effect.kind();
    let fits = effect.column_fits(&disagreement).into_iter();
    let parts = fits.map(|values| Part { kind, values });
    parts.min_by(|a, b| residual(columns, a).total_cmp(&residual(columns, b)))
}

/// Mean squared residual of an effect.
fn residual(columns: &Columns, part: &Part) -> f64 {
    mean_square(&residuals(&columns.tracks, part.kind, &part.values))
}

impl Part {
    /// Number of fitted parameters.
    fn count(&self) -> usize {
        effects::of(self.kind.name).count_in_columns(&self.values)
    }
}

fn mapped(columns: &Columns, of: impl Fn(&Track) -> Track) -> Columns {
    Columns {
        tracks: columns.tracks.iter().map(of).collect(),
        variance: columns.variance,
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let count = self.values.len();
        let values = self.values.iter().enumerate();
        let changed =
            values.filter(|(place, value)| **value != self.kind.parameter(*place).default);
        let changed = changed
            .map(|(place, value)| format!("{} {value:.3e}", self.kind.value_name(place, count)));
        write!(
            f,
            "{} ({})",
            self.kind.name,
            changed.collect::<Vec<_>>().join(", ")
        )
    }
}
