//! Robust nonlinear least squares on whitened window residuals.

use super::costs::Costs;
use super::fitted::Fit;
use super::hypothesis::Hypothesis;
use super::linearization::Linearization;
use super::part::Part;
use super::problem::{PRIOR_WEIGHT, Problem};
use super::slopes::{DIFFERENCES, Slope, aside, within};
use super::whitening::{Whitening, dot};
use crate::predict::Predictor;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;

/// The slopes along the model's own numbers, which move little, and how uncertain the restarts leave the windows are taken
/// anew at every third iteration, the slopes along effects before the last at every second.
const ANEW_EVERY: usize = 3;
const HELD_EVERY: usize = 2;
/// Iterations with the wide difference.
const WIDE: usize = 2;
/// Longest move of a coordinate in one iteration.
const LONGEST_MOVE: f64 = 1.5;
/// Iterations on either half.
const HALF_ITERATIONS: usize = 5;
const FIRST_DAMPING: f64 = 1e-2;
const MOST_DAMPING: f64 = 1e4;
/// An iteration that gains less than this share of the cost is the last.
const LEAST_GAIN: f64 = 5e-4;
/// Unless a single window gains this much.
const LEAST_WINDOW_GAIN: f64 = 0.1;

impl Problem<'_> {
    /// What `of` says of each window under a fit to the half that it is not in, by running index. It says NaN of
    /// windows outside the part that it is given.
    pub(crate) fn unseen(
        &self,
        fit: &Fit,
        of: impl Fn(&Fit, Part<'_>) -> Vec<f64> + Sync,
    ) -> Vec<f64> {
        Self::unseen_by(&self.halves(fit), of)
    }

    /// What `of` says of each window under that of [`Problem::halves`] that has not seen it.
    pub(crate) fn unseen_by(
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

    /// A fit gone on with on either half of the windows alone.
    pub(crate) fn halves(&self, fit: &Fit) -> [Fit; 2] {
        let on = |half| {
            let x = fit.x.clone();
            self.fit(&fit.hypothesis, x, Part::Half(half), HALF_ITERATIONS)
        };
        let (first, second) = rayon::join(|| on(true), || on(false));
        [first, second]
    }

    /// Fits `hypothesis` from `x` on a part of the windows by Levenberg's and Marquardt's method with
    /// iteratively re-weighted windows, `iterations` at most.
    pub(crate) fn fit(
        &self,
        hypothesis: &Hypothesis,
        x: Vec<f64>,
        part: Part<'_>,
        iterations: usize,
    ) -> Fit {
        self.fit_on(None, hypothesis, x, part, iterations)
    }

    /// The same on top of a fit, at a fraction of the time.
    pub(crate) fn fit_on(
        &self,
        linearization: Option<&Linearization>,
        hypothesis: &Hypothesis,
        mut x: Vec<f64>,
        part: Part<'_>,
        iterations: usize,
    ) -> Fit {
        let n = x.len();
        let held = n - hypothesis.terms.last().map_or(0, |term| term.free.len());
        let reaches = hypothesis.reaches(&self.priors);
        for (x, reach) in x.iter_mut().zip(&reaches) {
            *x = within(*x, *reach);
        }
        let predictor = self.predictor(hypothesis, &x);
        let residuals = self.residuals(&predictor, part);
        let known = linearization.map_or(&[][..], Linearization::slopes);
        let mut whitenings = match linearization {
            Some(linearization) => Cow::Borrowed(linearization.whitenings()),
            None => Cow::Owned(self.whitenings(&predictor, &residuals, part)),
        };
        let weighed_anew = |here: Point| {
            let whitenings = self.whitenings(&here.predictor, &here.residuals, part);
            let here = self.point(here.x, here.predictor, here.residuals, &whitenings);
            (here, Cow::Owned(whitenings))
        };
        let mut here = self.point(x, predictor, residuals, &whitenings);
        let mut best = (here.x.clone(), here.costs.clone());
        let mut damping = FIRST_DAMPING;
        let mut normal = DMatrix::zeros(n, n);
        let mut scatter = DMatrix::zeros(n, n);
        let mut slopes: Vec<Slope> = vec![Slope::new(); n - known.len()];
        for iteration in 0..iterations {
            if n == 0 {
                break;
            }
            if iteration > 0 && iteration % ANEW_EVERY == 0 && linearization.is_none() {
                (here, whitenings) = weighed_anew(here);
                here.keep_if_better(&mut best);
            }
            let difference = DIFFERENCES[usize::from(iteration >= WIDE)];
            slopes.par_iter_mut().enumerate().for_each(|(at, slope)| {
                let i = at + known.len();
                let every = if i < self.priors.len() {
                    ANEW_EVERY
                } else if i < held {
                    HELD_EVERY
                } else {
                    1
                };
                if iteration % every == 0 {
                    let difference = aside(here.x[i], difference, reaches[i]);
                    *slope = self.slope(hypothesis, &here.x, &here.residuals, i, difference, part);
                }
            });
            let columns: Vec<Vec<Vec<f64>>> = known
                .iter()
                .chain(&slopes)
                .map(|slope| self.whitened(slope, &whitenings))
                .collect();
            let gradient;
            (normal, scatter, gradient) = self.normal_equations(&here, &columns);
            let stuck = |&i: &usize| {
                let ([low, high], x) = (reaches[i], here.x[i]);
                (gradient[i] > 0.0 && x <= low) || (gradient[i] < 0.0 && x >= high)
            };
            let stuck: Vec<usize> = (0..n).filter(stuck).collect();
            let total = here.costs.sum();
            let mut improved = None;
            while damping < MOST_DAMPING {
                let Some(step) = damped_step(&normal, &gradient, damping, &stuck) else {
                    damping *= 10.0;
                    continue;
                };
                let moves = step.iter().map(|dx| dx.clamp(-LONGEST_MOVE, LONGEST_MOVE));
                let moved = here.x.iter().zip(moves).zip(&reaches);
                let trial: Vec<f64> = moved.map(|((x, by), r)| within(x - by, *r)).collect();
                let predictor = self.predictor(hypothesis, &trial);
                let residuals = self.residuals(&predictor, part);
                let there = self.point(trial, predictor, residuals, &whitenings);
                if there.costs.sum() < total {
                    damping = (0.2 * damping).max(1e-6);
                    improved = Some(there);
                    break;
                }
                damping *= 8.0;
            }
            let Some(there) = improved else {
                if iteration < WIDE {
                    damping = FIRST_DAMPING;
                    continue;
                }
                break;
            };
            here = there;
            let gain = total - here.costs.sum();
            if iteration >= WIDE && gain < (LEAST_GAIN * total).min(LEAST_WINDOW_GAIN) {
                break;
            }
        }
        if linearization.is_none() && here.x != best.0 {
            (here, _) = weighed_anew(here);
        }
        here.keep_if_better(&mut best);
        let (x, costs) = best;
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
    ) -> Point {
        let whitened = self.whitened(&residuals, whitenings);
        Point {
            costs: Costs::new(&whitened, self.prior(&x)),
            x,
            predictor,
            residuals,
            whitened,
        }
    }

    /// Of the robust cost at a point with slopes along all its coordinates, whitened: normal matrix, scatter of what the
    /// windows pull at it, and gradient.
    fn normal_equations(
        &self,
        here: &Point,
        columns: &[Vec<Vec<f64>>],
    ) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
        let n = columns.len();
        let mut gradient = DVector::zeros(n);
        let mut normal = DMatrix::zeros(n, n);
        let mut scatter = DMatrix::zeros(n, n);
        let windows = here.whitened.iter().enumerate();
        for (w, base) in windows.filter(|(_, r)| !r.is_empty()) {
            let weight = 1.0 / (base.len() as f64 * (1.0 + here.costs.per_sample[w]));
            let pulls = columns.iter().map(|c| weight * dot(&c[w], base));
            let pull = DVector::from_iterator(n, pulls);
            for i in 0..n {
                for j in 0..=i {
                    normal[(i, j)] += weight * dot(&columns[i][w], &columns[j][w]);
                }
            }
            scatter += &pull * pull.transpose();
            gradient += pull;
        }
        normal.fill_upper_triangle_with_lower_triangle();
        for i in 0..self.priors.len() {
            normal[(i, i)] += PRIOR_WEIGHT;
            gradient[i] += PRIOR_WEIGHT * here.x[i];
        }
        (normal, scatter, gradient)
    }
}

/// What a hypothesis leaves at a point, and what that costs as it is weighed there.
struct Point {
    x: Vec<f64>,
    predictor: Predictor,
    residuals: Vec<Vec<f64>>,
    whitened: Vec<Vec<f64>>,
    costs: Costs,
}

impl Point {
    /// Restarts weigh otherwise at each point, so that steps down may turn out to lead up.
    fn keep_if_better(&self, best: &mut (Vec<f64>, Costs)) {
        if self.costs.sum() < best.1.sum() {
            *best = (self.x.clone(), self.costs.clone());
        }
    }
}

/// The step down; along coordinates that are `stuck` none, the others move as if those were fixed. None if there is no such
/// step.
fn damped_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
    stuck: &[usize],
) -> Option<DVector<f64>> {
    let mut damped = normal.clone();
    for i in 0..normal.nrows() {
        damped[(i, i)] += damping * normal[(i, i)] + 1e-9;
    }
    let mut pull = gradient.clone();
    for &i in stuck {
        damped.row_mut(i).fill(0.0);
        damped.column_mut(i).fill(0.0);
        damped[(i, i)] = 1.0;
        pull[i] = 0.0;
    }
    Some(damped.cholesky()?.solve(&pull))
}

/// Standard deviations by the sandwich of Huber (Berkeley Symposium 5, 1967), windows as clusters: what
/// is left inside a window is anything but independent.
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

    /// What terms come to on a recording with the effects written in `effects`.
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
    fn a_size_is_found_far_from_where_it_was_looked_for() {
        let spring = term("spring", &[(0, 0.03, 0.01), (1, 0.0, 0.1)]);
        let [stiffness, _] = fitted(&["spring:stiffness=0.15,zero=0"], vec![spring])[..] else {
            panic!("two numbers");
        };
        assert!((stiffness - 0.15).abs() < 1e-3, "{stiffness}");
    }

    #[test]
    fn a_number_at_the_end_of_its_range_holds_no_other_up_and_comes_back() {
        let viscous = |start| term("viscous", &[(0, start, 1e-3)]);
        let spring = term("spring", &[(0, 0.03, 0.01), (1, 0.0, 0.1)]);
        let hidden = "spring:stiffness=0.06,zero=0";
        let found = fitted(
            &["viscous:coefficient=0", hidden],
            vec![viscous(4e-3), spring.clone()],
        );
        assert!((0.0..1e-5).contains(&found[0]), "{found:?}");
        assert!((found[1] - 0.06).abs() < 1e-3, "{found:?}");

        let found = fitted(
            &["viscous:coefficient=0.004", hidden],
            vec![viscous(-2e-3), spring],
        );
        assert!((found[0] - 4e-3).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn what_acts_for_a_while_is_looked_at_meanwhile_and_changes_nothing_else() {
        let recording = made::recording(&[]);
        let problem = made::problem(&recording);
        let mut hand = term("contact", &[(0, 0.3, 0.1), (5, 3.0, 0.5)]);
        (hand.values[2], hand.values[3], hand.values[4]) = (0.0, 0.0, 2.5);
        let hypothesis = Hypothesis { terms: vec![hand] };
        let left = |x: &[f64]| {
            let predictor = problem.predictor(&hypothesis, x);
            problem.residuals(&predictor, Part::All).concat()
        };
        let here = problem.residuals(&problem.predictor(&hypothesis, &[0.0; 2]), Part::All);
        for (i, moved) in [[1.0, 0.0], [0.0, 1.0]].iter().enumerate() {
            let slope = problem.slope(&hypothesis, &[0.0; 2], &here, i, 1.0, Part::All);
            let there = left(moved).into_iter().zip(here.concat());
            let expected: Vec<f64> = there.map(|(there, here)| there - here).collect();
            assert_eq!(slope.concat(), expected);
            assert!(expected.iter().any(|change| *change != 0.0));
        }
    }
}
