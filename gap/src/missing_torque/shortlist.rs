//! Sets of up to three effects that explain a missing torque, with their numbers.

use super::form::{Form, Values};
use super::numbers::numbers;
use super::path::Path;
use super::regression::{Normal, Rows};
use super::smoother::Smoother;
use super::target::Target;
use crate::effects::{self, Identification};
use rayon::prelude::*;
use recording::Recording;

/// Effects that go together at most.
const MOST: usize = 3;
/// Effects that sets of three are made of.
const OF_THREE: usize = 12;
/// By how much the logarithm of what is left must fall for a further coefficient, or for a number that was searched for.
const PER_COEFFICIENT: f64 = 0.03;
const PER_SEARCHED: f64 = 0.03;
/// Likewise for a further effect.
const PER_EFFECT: f64 = 0.15;
/// Share of the missing torque that another formula for the same effect may leave.
const NEGLIGIBLE: f64 = 0.008;
/// Columns that go through the smoother at once.
const LANES: usize = 8;

/// A set of effects with their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Names and numbers, in the order of each kind's parameters.
    pub effects: Vec<(&'static str, Vec<f64>)>,
    /// Share of the missing torque, squared, that they explain on blocks of time that were held out.
    pub share: f64,
}

/// An effect in the form that explains most.
pub(super) struct Group {
    effect: &'static dyn Identification,
    /// Smoothed as the missing torque is, at the rows of a fit.
    pub columns: Vec<Vec<f64>>,
    values: Values,
    searched: usize,
    seldom: bool,
    positive: bool,
}

/// All effects in their best forms, beside the numbers of the model that are known to within a tolerance only.
pub(super) struct Field {
    groups: Vec<Group>,
    known: usize,
    normal: Normal,
}

impl Field {
    pub fn of(
        recording: &Recording,
        path: &Path<'_>,
        smoother: &Smoother<'_>,
        rows: &Rows,
        target: &Target<'_>,
    ) -> Self {
        let missing = rows.of(target.torque);
        let known = respond(smoother, rows, &numbers(recording, path), &[]);
        let effects: Vec<&dyn Identification> = effects::all().collect();
        let groups = effects.into_par_iter().filter_map(|effect| {
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
            Some(Group {
                effect,
                columns,
                values,
                searched,
                seldom,
                positive,
            })
        });
        let groups: Vec<Group> = groups.collect();
        let all = known.iter().chain(groups.iter().flat_map(|g| &g.columns));
        let all: Vec<&[f64]> = all.map(Vec::as_slice).collect();
        let mut normal = Normal::of(rows, &all, known.len(), &missing);
        let mut first = known.len();
        for group in &groups {
            let own: Vec<usize> = (first..first + group.columns.len()).collect();
            first += group.columns.len();
            if group.seldom {
                normal.fix(&own, &normal.fit(&own));
            }
        }
        Self {
            groups,
            known: known.len(),
            normal,
        }
    }

    /// The `count` best sets, the best first.
    pub fn shortlist(&self, count: usize) -> Vec<Proposal> {
        let ones: Vec<Vec<usize>> = (0..self.groups.len()).map(|g| vec![g]).collect();
        let mut all = self.scored(ones);
        let pairs = (0..self.groups.len()).flat_map(|a| (0..a).map(move |b| vec![b, a]));
        all.extend(self.scored(pairs.collect()));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut members: Vec<usize> = Vec::new();
        for (_, set) in &all {
            for group in set {
                if members.len() < OF_THREE && !members.contains(group) {
                    members.push(*group);
                }
            }
        }
        members.sort_unstable();
        let mut threes = Vec::new();
        for (i, &a) in members.iter().enumerate() {
            for (j, &b) in members.iter().enumerate().skip(i + 1) {
                threes.extend(members[j + 1..].iter().map(|&c| vec![a, b, c]));
            }
        }
        debug_assert!(threes.iter().all(|set| set.len() <= MOST));
        all.extend(self.scored(threes));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.truncate(count);
        let sets = all.into_iter().map(|(_, set)| self.ordered(set));
        sets.map(|set| self.proposal(&set)).collect()
    }

    /// A set in the order of what each effect explains: its Shapley share times what it explains alone.
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
                // Orders in which the members of `mask` come before and the others after.
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

    /// Sets with their scores, the lower the better.
    fn scored(&self, sets: Vec<Vec<usize>>) -> Vec<(f64, Vec<usize>)> {
        let scored = sets.into_par_iter().map(|set| {
            let columns = self.columns(&set);
            let all = self.normal.target_squares().max(f64::MIN_POSITIVE);
            let left = self.normal.held_out(&columns) / all;
            let searched = set.iter().map(|&g| self.groups[g].searched).sum();
            let score = score(left, columns.len() - self.known, searched, set.len());
            (self.makes_sense(&set, &columns).then_some(score), set)
        });
        let sensible = scored.filter_map(|(score, set)| Some((score?, set)));
        sensible.collect()
    }

    /// Whether every coefficient that must be above 0 is.
    fn makes_sense(&self, set: &[usize], columns: &[usize]) -> bool {
        let coefficients = self.normal.fit(columns);
        let mut first = self.known;
        set.iter().all(|&group| {
            let group = &self.groups[group];
            let coefficient = coefficients[first];
            first += group.columns.len();
            coefficient > 0.0 || !group.positive
        })
    }

    /// Columns of a set, those of the model's numbers first.
    fn columns(&self, set: &[usize]) -> Vec<usize> {
        let mut columns: Vec<usize> = (0..self.known).collect();
        for &group in set {
            let before = self.groups[..group].iter().map(|g| g.columns.len());
            let first = self.known + before.sum::<usize>();
            columns.extend(first..first + self.groups[group].columns.len());
        }
        columns
    }

    fn proposal(&self, set: &[usize]) -> Proposal {
        let columns = self.columns(set);
        let coefficients = self.normal.fit(&columns);
        let mut rest = &coefficients[self.known..];
        let effects = set.iter().map(|&group| {
            let group = &self.groups[group];
            let (own, others) = rest.split_at(group.columns.len());
            rest = others;
            (group.effect.name(), (group.values)(own))
        });
        let effects = effects.collect();
        let left = self.normal.held_out(&columns);
        let all = self.normal.target_squares().max(f64::MIN_POSITIVE);
        Proposal {
            effects,
            share: 1.0 - left / all,
        }
    }

    /// What a set of effects explains of the missing torque at each row of the fit.
    pub fn explained(&self, names: &[&str]) -> Vec<f64> {
        let named = self.groups.iter().enumerate();
        let set: Vec<usize> = named
            .filter(|(_, g)| names.contains(&g.effect.name()))
            .map(|(i, _)| i)
            .collect();
        let coefficients = self.normal.fit(&self.columns(&set));
        let columns = set.iter().flat_map(|&g| &self.groups[g].columns);
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

/// Logarithm of the share that is left, and what coefficients, searches and further effects must have brought at least.
fn score(left: f64, coefficients: usize, searched: usize, effects: usize) -> f64 {
    (left + NEGLIGIBLE).ln()
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
    let left = normal.held_out(&every) / normal.target_squares().max(f64::MIN_POSITIVE);
    score(left, columns.len(), form.searched, 1)
}

/// Torques (and errors of the reading, if any) as the smoother shows them, at the rows of a fit.
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
