//! The linearized prediction around a fit. All fits of one more effect share it, and it predicts their cost to first order.

use super::fitted::Fit;
use super::hypothesis::Hypothesis;
use super::part::Part;
use super::problem::{PRIOR_WEIGHT, Problem};
use super::slopes::{DIFFERENCES, Slope, difference_within};
use super::whitening::{Whitening, dot};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::mem;

/// The prediction near a fit to first order: the residuals, their slopes along the coordinates of the fit, and the whitening of each
/// window, which accounts for the uncertainty of the restarts.
pub(crate) struct Linearization {
    x: Vec<f64>,
    residuals: Vec<Vec<f64>>,
    slopes: Vec<Slope>,
    whitenings: Vec<Option<Whitening>>,
    windows: Vec<WindowModel>,
}

/// The linear model of one window that takes part.
struct WindowModel {
    /// Running index of the window over all series.
    index: usize,
    /// The whitened residuals and their whitened slopes.
    columns: Vec<Vec<f64>>,
    /// Mean products of any two columns.
    products: DMatrix<f64>,
}

/// The linear model of an additional effect at a point, for each window that takes part.
pub(crate) struct EffectModel {
    windows: Vec<EffectInWindow>,
}

/// The linear model of an additional effect in one window.
struct EffectInWindow {
    /// Whitened change of the residuals by the effect, and whitened slopes along the coordinates of the effect.
    columns: Vec<Vec<f64>>,
    /// Mean products of these columns, one per row, with the columns of the known fit and then with each other.
    products: DMatrix<f64>,
}

/// Largest step along a coordinate of an effect.
const LARGEST_STEP: f64 = 1.5;
/// Range of the factor by which the change of the residuals by an effect may be scaled.
const SCALE_RANGE: [f64; 2] = [0.2, 5.0];
/// Number of reweightings of the windows.
const REWEIGHTINGS: usize = 4;

impl Problem<'_> {
    /// The linearization around `fit` on a part of the windows.
    pub(crate) fn linearization(&self, fit: &Fit, part: Part<'_>) -> Linearization {
        let predictor = self.predictor(&fit.hypothesis, &fit.x);
        let residuals = self.residuals(&predictor, part);
        let reaches = fit.hypothesis.reaches(&self.priors);
        let along = |i| {
            let difference = difference_within(fit.x[i], DIFFERENCES[0], reaches[i]);
            self.slope(&fit.hypothesis, &fit.x, &residuals, i, difference, part)
        };
        let slopes: Vec<Slope> = (0..fit.x.len()).into_par_iter().map(along).collect();
        let whitenings = self.whitenings(&predictor, &residuals, part);
        let columns = [&residuals].into_iter().chain(&slopes);
        let columns: Vec<Vec<Vec<f64>>> = columns.map(|c| self.whitened(c, &whitenings)).collect();
        let taken = (0..whitenings.len()).filter(|&w| whitenings[w].is_some());
        Linearization {
            windows: taken.map(|w| WindowModel::of(&columns, w)).collect(),
            x: fit.x.clone(),
            residuals,
            slopes,
            whitenings,
        }
    }
}

impl WindowModel {
    fn of(columns: &[Vec<Vec<f64>>], index: usize) -> Self {
        let columns: Vec<Vec<f64>> = columns.iter().map(|c| c[index].clone()).collect();
        let n = columns.len();
        let mean = |i: usize, j: usize| mean_product(&columns[i], &columns[j]);
        Self {
            index,
            products: DMatrix::from_fn(n, n, mean),
            columns,
        }
    }

    /// Adds the columns of an effect.
    fn with_effect(&self, columns: Vec<Vec<f64>>) -> EffectInWindow {
        let all: Vec<&Vec<f64>> = self.columns.iter().chain(&columns).collect();
        let mean = |i: usize, j: usize| mean_product(&columns[i], all[j]);
        let products = DMatrix::from_fn(columns.len(), all.len(), mean);
        EffectInWindow { columns, products }
    }

    /// Mean products of the residuals with two effects and of all slopes.
    fn with_both(&self, [a, b]: [&EffectInWindow; 2]) -> DMatrix<f64> {
        let known = self.columns.len();
        let [own_a, own_b] = [a, b].map(|along| along.columns.len() - 1);
        let count = known + own_a + own_b;
        // The changes by the effects come last because they are added to the residuals below.
        let place = |first: usize, last: usize| {
            move |column: usize| {
                if column == 0 {
                    last
                } else {
                    first + column - 1
                }
            }
        };
        let places = [place(known, count), place(known + own_a, count + 1)];
        let mut all = self.products.clone().resize(count + 2, count + 2, 0.0);
        let mut put = |i: usize, j: usize, product: f64| {
            (all[(i, j)], all[(j, i)]) = (product, product);
        };
        for (along, place) in [a, b].into_iter().zip(&places) {
            for i in 0..along.columns.len() {
                (0..known).for_each(|j| put(place(i), j, along.products[(i, j)]));
                (0..=i).for_each(|j| put(place(i), place(j), along.products[(i, known + j)]));
            }
        }
        for (i, of_a) in a.columns.iter().enumerate() {
            for (j, of_b) in b.columns.iter().enumerate() {
                put(places[0](i), places[1](j), mean_product(of_a, of_b));
            }
        }
        for i in 0..count + 2 {
            let changes = all[(count, i)] + all[(count + 1, i)];
            all[(0, i)] += changes;
        }
        for i in 0..count + 2 {
            let changes = all[(i, count)] + all[(i, count + 1)];
            all[(i, 0)] += changes;
        }
        all.resize(count, count, 0.0)
    }

    /// The mean products with one more column.
    fn with(&self, column: &[f64]) -> DMatrix<f64> {
        let n = self.columns.len();
        let mut products = self.products.clone().resize(n + 1, n + 1, 0.0);
        for (i, own) in self.columns.iter().enumerate() {
            products[(i, n)] = mean_product(own, column);
            products[(n, i)] = products[(i, n)];
        }
        products[(n, n)] = mean_product(column, column);
        products
    }
}

fn mean_product(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b) / a.len().max(1) as f64
}

/// Mean square of the sum of the columns, each multiplied by its factor.
fn cost(products: &DMatrix<f64>, factors: &DVector<f64>) -> f64 {
    let columns = products.column_iter().zip(factors);
    let sum: f64 = columns.map(|(column, by)| by * column.dot(factors)).sum();
    sum.clamp(0.0, f64::MAX)
}

/// Sum over the windows of the mean products, each weighted by its robust weight at the given factors. The first `slopes` factors after
/// the one of the residuals are steps along slopes, on which a prior is set because slopes are valid only nearby.
fn weighted_sum(
    priors: &[f64],
    products: &[DMatrix<f64>],
    factors: &DVector<f64>,
    slopes: usize,
) -> DMatrix<f64> {
    let n = factors.len();
    let mut normal = DMatrix::zeros(n, n);
    for products in products {
        let weight = 1.0 / (1.0 + cost(products, factors));
        normal.zip_apply(products, |sum, product| *sum += weight * product);
    }
    for i in 1..=slopes {
        normal[(i, i)] += PRIOR_WEIGHT;
    }
    for (i, z) in priors.iter().enumerate() {
        normal[(i + 1, 0)] += PRIOR_WEIGHT * z;
    }
    normal
}

/// The steps along the first `count` slopes that minimize the cost for the given other factors.
fn minimizing_steps(
    normal: &DMatrix<f64>,
    count: usize,
    given: &DVector<f64>,
) -> Option<DVector<f64>> {
    let square = normal.view((1, 1), (count, count)).clone_owned();
    let gradient = normal.rows(1, count) * given;
    Some(-square.cholesky()?.solve(&gradient))
}

impl Linearization {
    /// The slopes of the residuals along the coordinates of the fit.
    pub(crate) fn slopes(&self) -> &[Slope] {
        &self.slopes
    }

    /// Information matrix of the coordinates from the windows and from the tolerances of the first `priors` coordinates, in inverse
    /// squared standard deviations. The residuals of a window are not independent noise, so a whole window counts like one observation.
    pub(crate) fn information(&self, priors: usize) -> DMatrix<f64> {
        let known = self.x.len();
        let mut normal = DMatrix::zeros(known, known);
        for WindowModel { products, .. } in &self.windows {
            normal += products.view((1, 1), (known, known)) / (1.0 + products[(0, 0)]);
        }
        for i in 0..priors {
            normal[(i, i)] += PRIOR_WEIGHT;
        }
        normal / PRIOR_WEIGHT
    }

    /// The whitening of each window, by running index.
    pub(crate) fn whitenings(&self) -> &[Option<Whitening>] {
        &self.whitenings
    }

    /// Robust cost per window of `hypothesis`, which is the known fit with one more effect at `x`. It is computed linearly from one
    /// simulation: the change by the effect is scaled, and the coordinates of the known fit adapt.
    pub(crate) fn linear_cost(
        &self,
        problem: &Problem<'_>,
        hypothesis: &Hypothesis,
        x: &[f64],
        part: Part<'_>,
    ) -> f64 {
        let there = problem.residuals(&problem.predictor(hypothesis, x), part);
        let change = problem.whitened(&self.change_from_known(there), &self.whitenings);
        let products = self.windows.iter().map(|w| w.with(&change[w.index]));
        let products: Vec<DMatrix<f64>> = products.collect();
        let priors = &self.x[..problem.priors.len()];
        let factors = self.factors_with_scaling(priors, &products);
        self.robust(priors, &products, &factors)
    }

    /// The residuals less those of the known fit.
    fn change_from_known(&self, mut residuals: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (residuals, known) in residuals.iter_mut().zip(&self.residuals) {
            for (r, k) in residuals.iter_mut().zip(known) {
                *r -= k;
            }
        }
        residuals
    }

    /// The linear model of the last effect of `hypothesis` at `x`. The hypothesis is the known fit with one more effect.
    pub(crate) fn effect_model(
        &self,
        problem: &Problem<'_>,
        hypothesis: &Hypothesis,
        x: &[f64],
        part: Part<'_>,
    ) -> EffectModel {
        let there = problem.residuals(&problem.predictor(hypothesis, x), part);
        let reaches = hypothesis.reaches(&problem.priors);
        let own = self.x.len()..x.len();
        let slopes = own.into_par_iter().map(|i| {
            let difference = difference_within(x[i], DIFFERENCES[0], reaches[i]);
            problem.slope(hypothesis, x, &there, i, difference, part)
        });
        let slopes: Vec<Slope> = slopes.collect();
        let change = self.change_from_known(there);
        let columns = [&change].into_iter().chain(&slopes);
        let whitened = columns.map(|column| problem.whitened(column, &self.whitenings));
        let mut whitened: Vec<Vec<Vec<f64>>> = whitened.collect();
        let windows = self.windows.iter().map(|window| {
            let columns = whitened.iter_mut();
            window.with_effect(columns.map(|c| mem::take(&mut c[window.index])).collect())
        });
        EffectModel {
            windows: windows.collect(),
        }
    }

    /// Robust cost per window of two effects together, linearly around the point of each.
    pub(crate) fn linear_cost_of_both(&self, priors: usize, both: [&EffectModel; 2]) -> f64 {
        let windows = self.windows.iter().enumerate();
        let products = windows.map(|(w, window)| window.with_both(both.map(|d| &d.windows[w])));
        let products: Vec<DMatrix<f64>> = products.collect();
        let priors = &self.x[..priors];
        let factors = self.factors_without_scaling(priors, &products);
        self.robust(priors, &products, &factors)
    }

    /// The factors of the columns that minimize the robust cost with the factor of the residuals fixed at 1.
    fn factors_without_scaling(&self, priors: &[f64], products: &[DMatrix<f64>]) -> DVector<f64> {
        let columns = products.first().map_or(1, DMatrix::nrows);
        let mut factors = DVector::zeros(columns);
        factors[0] = 1.0;
        for _ in 0..REWEIGHTINGS {
            let normal = weighted_sum(priors, products, &factors, columns - 1);
            let mut given = DVector::zeros(columns);
            given[0] = 1.0;
            let Some(moves) = minimizing_steps(&normal, columns - 1, &given) else {
                break;
            };
            for (i, by) in moves.iter().enumerate() {
                let far = if i < self.x.len() {
                    f64::MAX
                } else {
                    LARGEST_STEP
                };
                factors[i + 1] = by.clamp(-far, far);
            }
        }
        factors
    }

    /// Robust cost per window at the given factors, with the prior cost.
    fn robust(&self, priors: &[f64], products: &[DMatrix<f64>], factors: &DVector<f64>) -> f64 {
        let costs = products.iter().map(|p| cost(p, factors).ln_1p());
        let moved = priors.iter().zip(factors.iter().skip(1));
        let prior = moved.map(|(z, by)| PRIOR_WEIGHT * (z + by).powi(2));
        (costs.sum::<f64>() + prior.sum::<f64>()) / products.len().max(1) as f64
    }

    /// The factors of the columns that minimize the robust cost, by iteratively reweighted windows: 1 for the residuals, the steps of the
    /// known coordinates, and the scale of the new effect.
    fn factors_with_scaling(&self, priors: &[f64], products: &[DMatrix<f64>]) -> DVector<f64> {
        let known = self.x.len();
        let size = known + 1;
        let mut factors = DVector::zeros(known + 2);
        (factors[0], factors[size]) = (1.0, 1.0);
        for _ in 0..REWEIGHTINGS {
            let normal = weighted_sum(priors, products, &factors, known);
            let mut given = DVector::zeros(known + 2);
            given[0] = 1.0;
            let Some(all) = minimizing_steps(&normal, known + 1, &given) else {
                break;
            };
            given[size] = all[known].clamp(SCALE_RANGE[0], SCALE_RANGE[1]);
            let Some(moves) = minimizing_steps(&normal, known, &given) else {
                break;
            };
            factors.copy_from(&given);
            factors.rows_mut(1, known).copy_from(&moves);
        }
        factors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::term::{Coordinate, Scale};

    /// A spring that is relaxed at position zero.
    fn spring(stiffness: f64) -> Hypothesis {
        let stiff = Coordinate {
            parameter: 0,
            start: stiffness,
            scale: Scale::Log,
        };
        Hypothesis {
            terms: vec![made::term("spring", &[stiff])],
        }
    }

    #[test]
    fn the_linear_cost_of_an_effect_of_wrong_size_shows_what_the_right_size_gains() {
        let recording = made::recording(&["spring:stiffness=0.06,zero=0"]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let linearization = problem.linearization(&null, Part::All);
        let level = |stiffness| problem.costs(&spring(stiffness), &[0.0], Part::All).level();
        let predicted =
            |stiffness| linearization.linear_cost(&problem, &spring(stiffness), &[0.0], Part::All);
        let [nothing, right] = [null.costs.level(), level(0.06)];
        // Double and half the difference from the nominal stiffness.
        for wrong in [0.09, 0.045] {
            let [gained, predicted] = [level(wrong), predicted(wrong)].map(|l| nothing - l);
            assert!(predicted > 2.0 * gained.max(0.0) && predicted < 1.01 * (nothing - right));
        }
    }

    #[test]
    fn the_linear_cost_of_two_effects_shows_what_both_gain() {
        let recording = made::recording(&["viscous:coefficient=0.0006", "spring:stiffness=0.045"]);
        let problem = made::problem(&recording);
        let bare = Hypothesis { terms: Vec::new() };
        let null = problem.fit(&bare, Vec::new(), Part::All, 0);
        let linearization = problem.linearization(&null, Part::All);
        let along = |name: &str, start: f64, scale: f64| {
            let free = Coordinate {
                parameter: 0,
                start,
                scale: Scale::Linear(scale),
            };
            let hypothesis = Hypothesis {
                terms: vec![made::term(name, &[free])],
            };
            linearization.effect_model(&problem, &hypothesis, &[0.0], Part::All)
        };
        let model = &recording.model;
        let drag = along("viscous", model.viscous, 5e-4);
        let spring = along("spring", model.stiffness, 0.02);
        let offset = along("torque_offset", 0.0, 1e-3);
        let both = linearization.linear_cost_of_both(0, [&drag, &spring]);
        let nothing = null.costs.level();
        let others = [[&drag, &offset], [&spring, &offset]];
        for other in others.map(|pair| linearization.linear_cost_of_both(0, pair)) {
            assert!(nothing - both > 1.3 * (nothing - other), "{both} {other}");
        }
    }
}
