//! Robust nonlinear least squares on whitened window residuals.

use super::costs::Costs;
use super::fitted::Fit;
use super::hypothesis::Hypothesis;
use super::linearization::Linearization;
use super::objective::GapEquations;
use super::part::Part;
use super::problem::{PRIOR_WEIGHT, Problem};
use super::slopes::{DIFFERENCES, Slope, clamped, difference_within};
use super::whitening::{Whitening, dot};
use crate::predict::Predictor;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;

/// The slopes along the model parameters and the whitenings are computed anew in every third iteration, because they change little. The
/// slopes along the effects before the last one are computed anew in every second.
const REFRESH_EVERY: usize = 3;
const EARLIER_EVERY: usize = 2;
/// Number of iterations with the wide finite difference.
const WIDE_ITERATIONS: usize = 2;
/// Largest step of a coordinate in one iteration.
const LARGEST_STEP: f64 = 1.5;
/// Number of iterations of a fit to one half of the windows.
const HALF_ITERATIONS: usize = 5;
const FIRST_DAMPING: f64 = 1e-2;
const MOST_DAMPING: f64 = 1e4;
/// The fit ends after an iteration that gains less than this share of the cost.
const LEAST_GAIN: f64 = 5e-4;
/// The fit continues if an iteration gains more than this robust cost.
const LEAST_WINDOW_GAIN: f64 = 0.1;

impl Problem<'_> {
    /// The value of `of` for each window under a fit to the half of the windows that does not hold it, by running index. `of` must return
    /// NaN for windows outside the part that it is given.
    pub(crate) fn held_out(
        &self,
        fit: &Fit,
        of: impl Fn(&Fit, Part<'_>) -> Vec<f64> + Sync,
    ) -> Vec<f64> {
        Self::held_out_by(&self.halves(fit), of)
    }

    /// The value of `of` for each window under that fit of [`Problem::halves`] that was not fitted to it.
    pub(crate) fn held_out_by(
        [first, second]: &[Fit; 2],
        of: impl Fn(&Fit, Part<'_>) -> Vec<f64> + Sync,
    ) -> Vec<f64> {
        let (first, second) = rayon::join(
            || of(first, Part::Half(false)),
            || of(second, Part::Half(true)),
        );
        let pairs = first.into_iter().zip(second);
        pairs.map(|(a, b)| if a.is_nan() { b } else { a }).collect()
    }

    /// Continues a fit on each half of the windows alone.
    pub(crate) fn halves(&self, fit: &Fit) -> [Fit; 2] {
        let on = |half| {
            let x = fit.x.clone();
            self.fit(&fit.hypothesis, x, Part::Half(half), HALF_ITERATIONS)
        };
        let (first, second) = rayon::join(|| on(true), || on(false));
        [first, second]
    }

    /// Fits `hypothesis` from `x` to a part of the windows, by the Levenberg-Marquardt method with iteratively reweighted windows, in at
    /// most `iterations` iterations.
    pub(crate) fn fit(
        &self,
        hypothesis: &Hypothesis,
        x: Vec<f64>,
        part: Part<'_>,
        iterations: usize,
    ) -> Fit {
        self.fit_on(None, hypothesis, x, part, iterations)
    }

    /// Fits as [`Problem::fit`] does. With the linearization of a fit of all but the last effect it reuses the slopes and whitenings,
    /// which takes a fraction of the time.
    pub(crate) fn fit_on(
        &self,
        linearization: Option<&Linearization>,
        hypothesis: &Hypothesis,
        mut x: Vec<f64>,
        part: Part<'_>,
        iterations: usize,
    ) -> Fit {
        let n = x.len();
        let last_start = n - hypothesis.terms.last().map_or(0, |term| term.free.len());
        let ranges = hypothesis.reaches(&self.priors);
        for (x, range) in x.iter_mut().zip(&ranges) {
            *x = clamped(*x, *range);
        }
        let predictor = self.predictor(hypothesis, &x);
        let residuals = self.residuals(&predictor, part);
        let known = linearization.map_or(&[][..], Linearization::slopes);
        let mut whitenings = match linearization {
            Some(linearization) => Cow::Borrowed(linearization.whitenings()),
            None => Cow::Owned(self.whitenings(&predictor, &residuals, part)),
        };
        let rewhitened = |here: Point| {
            let whitenings = self.whitenings(&here.predictor, &here.residuals, part);
            let here = self.point(here.x, here.predictor, here.residuals, &whitenings, part);
            (here, Cow::Owned(whitenings))
        };
        let mut here = self.point(x, predictor, residuals, &whitenings, part);
        let mut best = here.scored();
        let mut damping = FIRST_DAMPING;
        let mut normal = DMatrix::zeros(n, n);
        let mut scatter = DMatrix::zeros(n, n);
        let mut slopes: Vec<Slope> = vec![Slope::new(); n - known.len()];
        for iteration in 0..iterations {
            if n == 0 {
                break;
            }
            if iteration > 0 && iteration % REFRESH_EVERY == 0 && linearization.is_none() {
                (here, whitenings) = rewhitened(here);
                here.keep_if_better(&mut best);
            }
            let difference = DIFFERENCES[usize::from(iteration >= WIDE_ITERATIONS)];
            slopes.par_iter_mut().enumerate().for_each(|(at, slope)| {
                let i = at + known.len();
                let every = if i < self.priors.len() {
                    REFRESH_EVERY
                } else if i < last_start {
                    EARLIER_EVERY
                } else {
                    1
                };
                if iteration % every == 0 {
                    let difference = difference_within(here.x[i], difference, ranges[i]);
                    *slope = self.slope(hypothesis, &here.x, &here.residuals, i, difference, part);
                }
            });
            let columns: Vec<Vec<Vec<f64>>> = known
                .iter()
                .chain(&slopes)
                .map(|slope| self.whitened(slope, &whitenings))
                .collect();
            let raw = known.iter().chain(&slopes);
            let of_gap = self.gap_equations(&here.residuals, raw, part);
            let gradient;
            (normal, scatter, gradient) = self.normal_equations(&here, &columns, of_gap.as_ref());
            let at_bound = |&i: &usize| {
                let ([low, high], x) = (ranges[i], here.x[i]);
                (gradient[i] > 0.0 && x <= low) || (gradient[i] < 0.0 && x >= high)
            };
            let at_bound: Vec<usize> = (0..n).filter(at_bound).collect();
            let total = here.objective;
            let mut improved = None;
            while damping < MOST_DAMPING {
                let Some(step) = damped_step(&normal, &gradient, damping, &at_bound) else {
                    damping *= 10.0;
                    continue;
                };
                let moves = step.iter().map(|dx| dx.clamp(-LARGEST_STEP, LARGEST_STEP));
                let moved = here.x.iter().zip(moves).zip(&ranges);
                let trial: Vec<f64> = moved.map(|((x, by), r)| clamped(x - by, *r)).collect();
                let predictor = self.predictor(hypothesis, &trial);
                let residuals = self.residuals(&predictor, part);
                let there = self.point(trial, predictor, residuals, &whitenings, part);
                if there.objective < total {
                    damping = (0.2 * damping).max(1e-6);
                    improved = Some(there);
                    break;
                }
                damping *= 8.0;
            }
            let Some(there) = improved else {
                if iteration < WIDE_ITERATIONS {
                    damping = FIRST_DAMPING;
                    continue;
                }
                break;
            };
            here = there;
            let gain = total - here.objective;
            // The objective may be zero or negative if it has a logarithm, so the gain is compared with the costs.
            let scale = here.costs.sum();
            if iteration >= WIDE_ITERATIONS && gain < (LEAST_GAIN * scale).min(LEAST_WINDOW_GAIN) {
                break;
            }
        }
        if linearization.is_none() && here.x != best.x {
            (here, _) = rewhitened(here);
        }
        here.keep_if_better(&mut best);
        let Best { x, costs, .. } = best;
        Fit {
            hypothesis: hypothesis.clone(),
            x,
            std: deviations(&normal, &scatter),
            costs,
        }
    }

    fn point(
        &self,
        x: Vec<f64>,
        predictor: Predictor,
        residuals: Vec<Vec<f64>>,
        whitenings: &[Option<Whitening>],
        part: Part<'_>,
    ) -> Point {
        let whitened = self.whitened(&residuals, whitenings);
        let costs = Costs::new(&whitened, self.prior(&x));
        Point {
            objective: self.objective(&costs, &residuals, part),
            costs,
            x,
            predictor,
            residuals,
            whitened,
        }
    }

    /// Normal matrix, scatter matrix of the scores of the windows, and gradient of the objective at a point. `columns` holds the whitened
    /// slopes along all coordinates.
    fn normal_equations(
        &self,
        here: &Point,
        columns: &[Vec<Vec<f64>>],
        of_gap: Option<&GapEquations<'_>>,
    ) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
        let n = columns.len();
        let mut gradient = DVector::zeros(n);
        let mut normal = DMatrix::zeros(n, n);
        let mut normal_of_gap = DMatrix::zeros(n, n);
        let mut scatter = DMatrix::zeros(n, n);
        let windows = here.whitened.iter().enumerate();
        for (w, base) in windows.filter(|(_, r)| !r.is_empty()) {
            let weight = 1.0 / (base.len() as f64 * (1.0 + here.costs.per_sample[w]));
            let mut score = DVector::zeros(n);
            let whitened: Vec<&[f64]> = columns.iter().map(|c| &*c[w]).collect();
            add_window(&mut normal, &mut score, weight, &whitened, base);
            if let Some(gap) = of_gap {
                let raw: Vec<&[f64]> = gap.slopes.iter().map(|slope| slope[w]).collect();
                let residual = gap.residuals[w];
                add_window(&mut normal_of_gap, &mut score, gap.weight, &raw, residual);
            }
            scatter += &score * score.transpose();
            gradient += score;
        }
        normal += normal_of_gap;
        normal.fill_upper_triangle_with_lower_triangle();
        for i in 0..self.priors.len() {
            normal[(i, i)] += PRIOR_WEIGHT;
            gradient[i] += PRIOR_WEIGHT * here.x[i];
        }
        (normal, scatter, gradient)
    }
}

/// The residuals of a hypothesis at a point, and their cost with given whitenings.
struct Point {
    x: Vec<f64>,
    predictor: Predictor,
    residuals: Vec<Vec<f64>>,
    whitened: Vec<Vec<f64>>,
    costs: Costs,
    objective: f64,
}

/// The best point of a fit so far. Each point was judged with its own whitenings.
struct Best {
    x: Vec<f64>,
    costs: Costs,
    objective: f64,
}

impl Point {
    /// Keeps this point if its objective with its own whitenings is lower. The whitenings differ between points, so a step that reduced the
    /// cost with fixed whitenings may have increased it.
    fn keep_if_better(&self, best: &mut Best) {
        if self.objective < best.objective {
            *best = self.scored();
        }
    }

    fn scored(&self) -> Best {
        Best {
            x: self.x.clone(),
            costs: self.costs.clone(),
            objective: self.objective,
        }
    }
}

/// Adds one window to the lower triangle of a normal matrix, and its gradient to `score`. `slopes` are those of its `residual`.
fn add_window(
    normal: &mut DMatrix<f64>,
    score: &mut DVector<f64>,
    weight: f64,
    slopes: &[&[f64]],
    residual: &[f64],
) {
    for i in 0..slopes.len() {
        score[i] += weight * dot(slopes[i], residual);
        for j in 0..=i {
            normal[(i, j)] += weight * dot(slopes[i], slopes[j]);
        }
    }
}

/// The damped step. The coordinates `at_bound` are kept fixed. Returns `None` if the damped matrix is not positive definite.
fn damped_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
    at_bound: &[usize],
) -> Option<DVector<f64>> {
    let mut damped = normal.clone();
    for i in 0..normal.nrows() {
        damped[(i, i)] += damping * normal[(i, i)] + 1e-9;
    }
    let mut score = gradient.clone();
    for &i in at_bound {
        damped.row_mut(i).fill(0.0);
        damped.column_mut(i).fill(0.0);
        damped[(i, i)] = 1.0;
        score[i] = 0.0;
    }
    Some(damped.cholesky()?.solve(&score))
}

/// Standard deviations by the sandwich estimator (Huber, Berkeley Symposium 5, 1967) with windows as clusters, since the residuals within
/// a window are correlated.
fn deviations(normal: &DMatrix<f64>, scatter: &DMatrix<f64>) -> Vec<f64> {
    let n = normal.nrows();
    match (normal + DMatrix::identity(n, n) * 1e-9).try_inverse() {
        Some(inverse) => {
            let covariance = &inverse * scatter * &inverse;
            (0..n).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect()
        }
        None => vec![f64::INFINITY; n],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made;
    use crate::term::{Coordinate, Scale, Term};

    fn term(name: &str, free: &[(usize, f64, f64)]) -> Term {
        let linear = |&(parameter, start, scale)| Coordinate {
            parameter,
            start,
            scale: Scale::Linear(scale),
        };
        let free: Vec<Coordinate> = free.iter().map(linear).collect();
        made::term(name, &free)
    }

    /// The fitted parameters of terms on a recording with `effects`.
    fn fitted(effects: &[&str], terms: Vec<Term>) -> Vec<f64> {
        let recording = made::recording(effects);
        let problem = made::problem(&recording);
        let hypothesis = Hypothesis { terms };
        let x = vec![0.0; hypothesis.free()];
        let fit = problem.fit(&hypothesis, x, Part::All, 15);
        let numbers = hypothesis.parts(&fit.x).flat_map(|(term, own)| {
            let values = term.at(own);
            term.free.iter().map(move |c| values[c.parameter])
        });
        numbers.collect()
    }

    #[test]
    fn a_parameter_far_from_its_start_is_found() {
        let spring = term("spring", &[(0, 0.03, 0.01), (1, 0.0, 0.1)]);
        let [stiffness, _] = fitted(&["spring:stiffness=0.15,zero=0"], vec![spring])[..] else {
            panic!("two numbers");
        };
        assert!((stiffness - 0.15).abs() < 1e-3, "{stiffness}");
    }

    #[test]
    fn a_parameter_at_a_bound_does_not_block_others_and_can_leave_it() {
        let drag = |start| term("quadratic_drag", &[(0, start, 2e-4)]);
        let spring = term("spring", &[(0, 0.03, 0.01), (1, 0.0, 0.1)]);
        let hidden = "spring:stiffness=0.06,zero=0";
        let found = fitted(
            &["quadratic_drag:coefficient=0", hidden],
            vec![drag(6e-4), spring.clone()],
        );
        assert!((0.0..1e-5).contains(&found[0]), "{found:?}");
        assert!((found[1] - 0.06).abs() < 1e-3, "{found:?}");

        let found = fitted(
            &["quadratic_drag:coefficient=6e-4", hidden],
            vec![drag(-3e-4), spring],
        );
        assert!((found[0] - 6e-4).abs() < 3e-5, "{found:?}");
    }

    #[test]
    fn a_slope_of_a_temporary_effect_equals_the_difference_of_all_residuals() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let mut contact = term("contact", &[(0, 0.3, 0.1), (5, 3.0, 0.5)]);
        (contact.values[2], contact.values[3], contact.values[4]) = (0.0, 0.0, 2.5);
        let hypothesis = Hypothesis {
            terms: vec![contact],
        };
        let residuals = |x: &[f64]| {
            let predictor = problem.predictor(&hypothesis, x);
            problem.residuals(&predictor, Part::All).concat()
        };
        let here = problem.residuals(&problem.predictor(&hypothesis, &[0.0; 2]), Part::All);
        for (i, moved) in [[1.0, 0.0], [0.0, 1.0]].iter().enumerate() {
            let slope = problem.slope(&hypothesis, &[0.0; 2], &here, i, 1.0, Part::All);
            let there = residuals(moved).into_iter().zip(here.concat());
            let expected: Vec<f64> = there.map(|(there, here)| there - here).collect();
            assert_eq!(slope.concat(), expected);
            assert!(expected.iter().any(|change| *change != 0.0));
        }
    }
}
