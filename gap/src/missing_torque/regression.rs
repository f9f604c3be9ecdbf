//! Weighted least squares from normal equations per fold, for cross-validation over blocks of time.

/// Number of folds to which the blocks of time are assigned.
pub(super) const FOLDS: usize = 5;
/// Ridge term, as a share of the square of a column. It keeps the coefficients finite if a column depends linearly on others.
const RIDGE: f64 = 1e-9;

/// The rows of a fit: those at which the missing torque is known, thinned to about two per time constant of the smoother.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// Indices of the rows in the recording.
    pub rows: Vec<usize>,
    /// Weight of each row: its equivalent number of independent readings over the variance of the torque.
    pub weight: Vec<f64>,
    /// Fold of each row, below [`FOLDS`].
    pub fold: Vec<usize>,
}

impl Rows {
    /// The values of a column at the rows of the fit.
    pub fn of(&self, column: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|&row| column[row]).collect()
    }
}

/// `Σ w c cᵀ` and `Σ w c y` of some columns c, and `Σ w y²`, for each fold and for all.
#[derive(Clone, Debug)]
pub(super) struct Normal {
    columns: usize,
    /// One entry for each fold, and a last one for all rows.
    products: Vec<Vec<f64>>,
    right: Vec<Vec<f64>>,
    squares: Vec<f64>,
    /// Prior of each column: the expected coefficient, and its precision (inverse variance). Both are 0 without a prior.
    prior: Vec<[f64; 2]>,
}

impl Normal {
    /// Builds the normal equations of `columns` for a target at the rows of a fit. The coefficients of the first `known` columns have a
    /// prior of 0 ± 1.
    pub fn of(rows: &Rows, columns: &[&[f64]], known: usize, target: &[f64]) -> Self {
        let n = columns.len();
        let mut normal = Self {
            columns: n,
            products: vec![vec![0.0; n * n]; FOLDS + 1],
            right: vec![vec![0.0; n]; FOLDS + 1],
            squares: vec![0.0; FOLDS + 1],
            prior: (0..n)
                .map(|k| [0.0, f64::from(u8::from(k < known))])
                .collect(),
        };
        let mut row = vec![0.0; n];
        for i in 0..rows.rows.len() {
            let (w, y, fold) = (rows.weight[i], target[i], rows.fold[i]);
            for (value, column) in row.iter_mut().zip(columns) {
                *value = column[i];
            }
            let products = &mut normal.products[fold];
            for a in 0..n {
                let wa = w * row[a];
                let into = &mut products[a * n..a * n + a + 1];
                for (sum, b) in into.iter_mut().zip(&row) {
                    *sum += wa * b;
                }
                normal.right[fold][a] += wa * y;
            }
            normal.squares[fold] += w * y * y;
        }
        for fold in 0..FOLDS {
            for a in 0..n {
                for b in 0..a {
                    normal.products[fold][b * n + a] = normal.products[fold][a * n + b];
                }
            }
            let (parts, all) = normal.products.split_at_mut(FOLDS);
            all[0]
                .iter_mut()
                .zip(&parts[fold])
                .for_each(|(a, b)| *a += b);
            let (parts, all) = normal.right.split_at_mut(FOLDS);
            all[0]
                .iter_mut()
                .zip(&parts[fold])
                .for_each(|(a, b)| *a += b);
            normal.squares[FOLDS] += normal.squares[fold];
        }
        normal
    }

    /// Sets priors from a fit to all rows, for the columns of an effect that acts once and is therefore visible in one fold only.
    pub fn fix(&mut self, columns: &[usize], coefficients: &[f64]) {
        for (&column, &coefficient) in columns.iter().zip(coefficients) {
            let own = self.products[FOLDS][column * self.columns + column];
            self.prior[column] = [coefficient, own];
        }
    }

    /// `Σ w y²` of all rows.
    pub fn target_squares(&self) -> f64 {
        self.squares[FOLDS]
    }

    /// Coefficients of some columns, fitted to all rows.
    pub fn fit(&self, columns: &[usize]) -> Vec<f64> {
        self.solve(columns, None)
    }

    /// Weighted sum of squared residuals on held-out folds, for fits of some columns to the other folds.
    pub fn held_out(&self, columns: &[usize]) -> f64 {
        let folds = (0..FOLDS).map(|fold| {
            let c = self.solve(columns, Some(fold));
            self.squares_left(columns, &c, fold)
        });
        folds.sum()
    }

    /// Weighted sum of squared residuals of one fold for given coefficients.
    fn squares_left(&self, columns: &[usize], c: &[f64], fold: usize) -> f64 {
        let (products, right) = (&self.products[fold], &self.right[fold]);
        let mut sum_left = self.squares[fold];
        for (&a, ca) in columns.iter().zip(c) {
            sum_left -= 2.0 * ca * right[a];
            let row = &products[a * self.columns..(a + 1) * self.columns];
            let sum: f64 = columns.iter().zip(c).map(|(&b, cb)| cb * row[b]).sum();
            sum_left += ca * sum;
        }
        sum_left.max(0.0)
    }

    /// Coefficients, fitted to all rows except those of a fold.
    fn solve(&self, columns: &[usize], without: Option<usize>) -> Vec<f64> {
        let k = columns.len();
        let n = self.columns;
        let all = &self.products[FOLDS];
        let mut a = vec![0.0; k * k];
        let mut b = vec![0.0; k];
        for (i, &p) in columns.iter().enumerate() {
            b[i] = self.right[FOLDS][p];
            for (j, &q) in columns.iter().take(i + 1).enumerate() {
                a[i * k + j] = all[p * n + q];
            }
            if let Some(fold) = without {
                b[i] -= self.right[fold][p];
                for (j, &q) in columns.iter().take(i + 1).enumerate() {
                    a[i * k + j] -= self.products[fold][p * n + q];
                }
            }
            let [mean, precision] = self.prior[p];
            a[i * k + i] += RIDGE * all[p * n + p] + precision + f64::MIN_POSITIVE;
            b[i] += precision * mean;
        }
        cholesky_solve(&mut a, &mut b, k);
        b
    }
}

/// Solves `a x = b` in place by Cholesky decomposition. `a` is the lower half of a symmetric matrix. An unknown with a pivot that is not
/// positive is set to 0.
fn cholesky_solve(a: &mut [f64], b: &mut [f64], k: usize) {
    for i in 0..k {
        for j in 0..i {
            let mut sum = a[i * k + j];
            for m in 0..j {
                sum -= a[i * k + m] * a[j * k + m];
            }
            a[i * k + j] = sum / a[j * k + j];
        }
        let mut pivot = a[i * k + i];
        for m in 0..i {
            pivot -= a[i * k + m] * a[i * k + m];
        }
        a[i * k + i] = if pivot > 0.0 {
            pivot.sqrt()
        } else {
            f64::INFINITY
        };
        let mut sum = b[i];
        for m in 0..i {
            sum -= a[i * k + m] * b[m];
        }
        b[i] = sum / a[i * k + i];
    }
    for i in (0..k).rev() {
        let mut sum = b[i];
        for m in i + 1..k {
            sum -= a[m * k + i] * b[m];
        }
        b[i] = sum / a[i * k + i];
        if !b[i].is_finite() {
            b[i] = 0.0;
        }
    }
}
