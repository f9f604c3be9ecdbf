//! Finds sets of up to three effects that explain a missing torque, with their parameters.

use super::form::{Form, Values};
use super::path::Path;
use super::regression::{Normal, Rows};
use super::smoother::Smoother;
use super::target::Target;
use super::tolerances::tolerance_torques;
use crate::effects::{self, Identification};
use rayon::prelude::*;
use recording::Recording;

/// Largest number of effects in a set.
const MOST: usize = 3;
/// Number of effects from which sets of three are formed.
const TRIPLE_MEMBERS: usize = 12;
/// Least decrease of the logarithm of the residual share per additional coefficient, and per searched parameter.
const PER_COEFFICIENT: f64 = 0.03;
const PER_SEARCHED: f64 = 0.03;
/// Least decrease of the logarithm of the residual share per additional effect.
const PER_EFFECT: f64 = 0.15;
/// Residual share that a different formula for the same effect may leave.
const NEGLIGIBLE: f64 = 0.008;
/// Number of columns that pass through the smoother at once.
const LANES: usize = 8;

/// A set of effects with their parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Names and parameters, in the order of the parameters of each kind.
    pub effects: Vec<(&'static str, Vec<f64>)>,
    /// Share of the squared missing torque that they explain on held-out blocks of time.
    pub share: f64,
}

/// An effect in the form that explains most.
pub(super) struct EffectColumns {
    effect: &'static dyn Identification,
    /// Columns of the effect, smoothed like the missing torque, at the rows of a fit.
    pub columns: Vec<Vec<f64>>,
    values: Values,
    searched: usize,
    seldom: bool,
    positive: bool,
}

/// The normal equations of all effects in their best forms, together with the model parameters that have a tolerance.
pub(super) struct ShortlistSearch {
    candidates: Vec<EffectColumns>,
    known: usize,
    normal: Normal,
}

impl ShortlistSearch {
    pub fn of(
        recording: &Recording,
        path: &Path<'_>,
        smoother: &Smoother<'_>,
        rows: &Rows,
        target: &Target<'_>,
    ) -> Self {
        let missing = rows.of(target.torque);
        let known = respond(smoother, rows, &tolerance_torques(recording, path), &[]);
        let effects: Vec<&dyn Identification> = effects::all().collect();
        let candidates = effects.into_par_iter().filter_map(|effect| {
            let forms = effect.torque_forms(path, target).into_iter();
            let tried = forms.map(|form| {
                let columns = respond(smoother, rows, &form.torque, &form.reading);
                let score = score_alone(rows, &known, &columns, &missing, &form);
                (score, form, columns)
            });
            let best = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let (_, form, columns) = best;
            let Form {
                values,
                searched,
                seldom,
                positive,
                ..
            } = form;
            Some(EffectColumns {
                effect,
                columns,
                values,
                searched,
                seldom,
                positive,
            })
        });
        let candidates: Vec<EffectColumns> = candidates.collect();
        let all = known
            .iter()
            .chain(candidates.iter().flat_map(|g| &g.columns));
        let all: Vec<&[f64]> = all.map(Vec::as_slice).collect();
        let mut normal = Normal::of(rows, &all, known.len(), &missing);
        let mut first = known.len();
        for group in &candidates {
            let own: Vec<usize> = (first..first + group.columns.len()).collect();
            first += group.columns.len();
            if group.seldom {
                normal.fix(&own, &normal.fit(&own));
            }
        }
        Self {
            candidates,
            known: known.len(),
            normal,
        }
    }

    /// The `count` best sets, best first.
    pub fn shortlist(&self, count: usize) -> Vec<Proposal> {
        let singles: Vec<Vec<usize>> = (0..self.candidates.len()).map(|g| vec![g]).collect();
        let mut all = self.scored(singles);
        let pairs = (0..self.candidates.len()).flat_map(|a| (0..a).map(move |b| vec![b, a]));
        all.extend(self.scored(pairs.collect()));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut members: Vec<usize> = Vec::new();
        for (_, set) in &all {
            for group in set {
                if members.len() < TRIPLE_MEMBERS && !members.contains(group) {
                    members.push(*group);
                }
            }
        }
        members.sort_unstable();
        let mut triples = Vec::new();
        for (i, &a) in members.iter().enumerate() {
            for (j, &b) in members.iter().enumerate().skip(i + 1) {
                triples.extend(members[j + 1..].iter().map(|&c| vec![a, b, c]));
            }
        }
        debug_assert!(triples.iter().all(|set| set.len() <= MOST));
        all.extend(self.scored(triples));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(count);
        let sets = all.into_iter().map(|(_, set)| self.ordered(set));
        sets.map(|set| self.proposal(&set)).collect()
    }

    /// Orders a set by the Shapley share of each effect times the squares that it explains alone.
    fn ordered(&self, set: Vec<usize>) -> Vec<usize> {
        let subset = |mask: usize| -> Vec<usize> {
            let members = set.iter().enumerate();
            members
                .filter(|(i, _)| mask >> i & 1 == 1)
                .map(|(_, g)| *g)
                .collect()
        };
        let all = self.normal.target_squares();
        let explained: Vec<f64> = (0..1 << set.len())
            .map(|mask| (all - self.normal.held_out(&self.columns(&subset(mask)))).max(0.0))
            .collect();
        let share = |i: usize| {
            let others = (0..explained.len()).filter(|mask| mask >> i & 1 == 0);
            let parts = others.map(|mask| {
                // Number of orders in which the members of `mask` come before and the others after.
                let before = mask.count_ones() as usize;
                let orders = factorial(before) * factorial(set.len() - 1 - before);
                orders * (explained[mask | 1 << i] - explained[mask])
            });
            parts.sum::<f64>().max(0.0) * explained[1 << i]
        };
        let mut order: Vec<usize> = (0..set.len()).collect();
        order.sort_by(|a, b| share(*b).total_cmp(&share(*a)));
        order.into_iter().map(|i| set[i]).collect()
    }

    /// Sets with their scores; a lower score is better. Sets with a coefficient of the wrong sign are left out.
    fn scored(&self, sets: Vec<Vec<usize>>) -> Vec<(f64, Vec<usize>)> {
        let scored = sets.into_par_iter().map(|set| {
            let columns = self.columns(&set);
            let all = self.normal.target_squares().max(f64::MIN_POSITIVE);
            let residual_share = self.normal.held_out(&columns) / all;
            let searched = set.iter().map(|&g| self.candidates[g].searched).sum();
            let score = score(
                residual_share,
                columns.len() - self.known,
                searched,
                set.len(),
            );
            (self.has_valid_signs(&set, &columns).then_some(score), set)
        });
        let valid = scored.filter_map(|(score, set)| Some((score?, set)));
        valid.collect()
    }

    /// True if every coefficient that must be positive is positive.
    fn has_valid_signs(&self, set: &[usize], columns: &[usize]) -> bool {
        let coefficients = self.normal.fit(columns);
        let mut first = self.known;
        set.iter().all(|&group| {
            let group = &self.candidates[group];
            let coefficient = coefficients[first];
            first += group.columns.len();
            coefficient > 0.0 || !group.positive
        })
    }

    /// Indices of the columns of a set, preceded by those of the model parameters.
    fn columns(&self, set: &[usize]) -> Vec<usize> {
        let mut columns: Vec<usize> = (0..self.known).collect();
        for &group in set {
            let before = self.candidates[..group].iter().map(|g| g.columns.len());
            let first = self.known + before.sum::<usize>();
            columns.extend(first..first + self.candidates[group].columns.len());
        }
        columns
    }

    fn proposal(&self, set: &[usize]) -> Proposal {
        let columns = self.columns(set);
        let coefficients = self.normal.fit(&columns);
        let mut rest = &coefficients[self.known..];
        let effects = set.iter().map(|&group| {
            let group = &self.candidates[group];
            let (own, others) = rest.split_at(group.columns.len());
            rest = others;
            (group.effect.name(), (group.values)(own))
        });
        let effects = effects.collect();
        let residual_squares = self.normal.held_out(&columns);
        let all = self.normal.target_squares().max(f64::MIN_POSITIVE);
        Proposal {
            effects,
            share: 1.0 - residual_squares / all,
        }
    }

    /// The part of the missing torque that a set of effects explains at each row of the fit.
    pub fn explained(&self, names: &[&str]) -> Vec<f64> {
        let named = self.candidates.iter().enumerate();
        let set: Vec<usize> = named
            .filter(|(_, g)| names.contains(&g.effect.name()))
            .map(|(i, _)| i)
            .collect();
        let coefficients = self.normal.fit(&self.columns(&set));
        let columns = set.iter().flat_map(|&g| &self.candidates[g].columns);
        let mut sum = Vec::new();
        for (column, coefficient) in columns.zip(&coefficients[self.known..]) {
            sum.resize(column.len(), 0.0);
            sum.iter_mut()
                .zip(column)
                .for_each(|(sum, value)| *sum += coefficient * value);
        }
        sum
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// Score of a set: the logarithm of the residual share, with a penalty for coefficients, searched parameters and effects.
fn score(residual_share: f64, coefficients: usize, searched: usize, effects: usize) -> f64 {
    (residual_share + NEGLIGIBLE).ln()
        + PER_COEFFICIENT * coefficients as f64
        + PER_SEARCHED * searched as f64
        + PER_EFFECT * effects as f64
}

fn score_alone(
    rows: &Rows,
    known: &[Vec<f64>],
    columns: &[Vec<f64>],
    target: &[f64],
    form: &Form,
) -> f64 {
    let all: Vec<&[f64]> = known.iter().chain(columns).map(Vec::as_slice).collect();
    let mut normal = Normal::of(rows, &all, known.len(), target);
    let every: Vec<usize> = (0..all.len()).collect();
    let own = &every[known.len()..];
    if form.seldom {
        normal.fix(own, &normal.fit(own));
    }
    let residual_share = normal.held_out(&every) / normal.target_squares().max(f64::MIN_POSITIVE);
    score(residual_share, columns.len(), form.searched, 1)
}

/// The response of the smoother to torques, and to sensor errors if any, at the rows of a fit.
pub(super) fn respond(
    smoother: &Smoother<'_>,
    rows: &Rows,
    torque: &[Vec<f64>],
    reading: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let mut columns = Vec::with_capacity(torque.len());
    match torque.len() {
        0 => {}
        1 => respond_in::<1>(smoother, rows, torque, reading, &mut columns),
        2 => respond_in::<2>(smoother, rows, torque, reading, &mut columns),
        3 | 4 => respond_in::<4>(smoother, rows, torque, reading, &mut columns),
        _ => {
            for (k, part) in torque.chunks(LANES).enumerate() {
                let reading = reading.get(k * LANES..).unwrap_or(&[]);
                respond_in::<LANES>(smoother, rows, part, reading, &mut columns);
            }
        }
    }
    columns
}

fn respond_in<const L: usize>(
    smoother: &Smoother<'_>,
    rows: &Rows,
    torque: &[Vec<f64>],
    reading: &[Vec<f64>],
    into: &mut Vec<Vec<f64>>,
) {
    let lanes = |columns: &[Vec<f64>]| -> Vec<[f64; L]> {
        let n = columns[0].len();
        (0..n)
            .map(|row| core::array::from_fn(|lane| columns.get(lane).map_or(0.0, |c| c[row])))
            .collect()
    };
    let read = (!reading.is_empty()).then(|| lanes(reading));
    let out = smoother.respond::<L>(&lanes(torque), read.as_deref());
    let lanes = (0..torque.len()).map(|lane| {
        let seen = rows.rows.iter().map(|&row| out[row][lane]);
        seen.collect()
    });
    into.extend(lanes);
}
