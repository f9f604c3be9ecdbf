//! A linear flow under forces that are held over a step, stepped exactly (Van Loan, IEEE Transactions on Automatic Control 23,
//! 1978).

/// `x' = R x + I f` for a state of D numbers and S forces, over a step and over half of it.
#[derive(Clone, Debug)]
pub(super) struct ZeroOrderHold<const D: usize, const S: usize> {
    /// The map over half a step.
    pub half: Map<D, S>,
    /// The map over a step.
    pub whole: Map<D, S>,
    rates: [[f64; D]; D],
    inputs: [[f64; D]; S],
}

/// The map of a state under forces over some time, by columns.
#[derive(Clone, Debug)]
pub(super) struct Map<const D: usize, const S: usize> {
    state: [[f64; D]; D],
    forces: [[f64; D]; S],
}

/// Largest norm of the argument of a series of [`TERMS`]: the error is then 1e-12.
const SMALL: f64 = 0.25;
const TERMS: u32 = 8;
/// Most halvings of a step. A motion that is faster decays within the step.
const MOST_HALVINGS: i32 = 30;

impl<const D: usize, const S: usize> ZeroOrderHold<D, S> {
    /// The maps for the columns of R and of I.
    pub(super) fn new(rates: [[f64; D]; D], inputs: [[f64; D]; S], step_s: f64) -> Self {
        let sum = |row: usize| rates.iter().map(|column| column[row].abs()).sum::<f64>();
        let norm = step_s * (0..D).map(sum).fold(0.0, f64::max);
        let halvings = ((norm / SMALL).log2().ceil() as i32).clamp(1, MOST_HALVINGS);
        let mut half = Map::over(&rates, &inputs, step_s * 0.5f64.powi(halvings));
        for _ in 1..halvings {
            half = half.twice();
        }
        Self {
            whole: half.twice(),
            half,
            rates,
            inputs,
        }
    }

    /// The state under forces by the short time `by_s` later or earlier, to second order.
    #[inline(always)]
    pub(super) fn soon(&self, x: &[f64; D], forces: &[f64; S], by_s: f64) -> [f64; D] {
        if by_s == 0.0 {
            return *x;
        }
        let free = combined(&self.rates, x);
        let forced = combined(&self.inputs, forces);
        let first: [f64; D] = core::array::from_fn(|i| free[i] + forced[i]);
        let second = combined(&self.rates, &first);
        core::array::from_fn(|i| x[i] + by_s * (first[i] + 0.5 * by_s * second[i]))
    }
}

impl<const D: usize, const S: usize> Map<D, S> {
    /// The map over a short time, by the series of the exponential and of its integral.
    fn over(rates: &[[f64; D]; D], inputs: &[[f64; D]; S], time_s: f64) -> Self {
        let mut state = [[0.0; D]; D];
        let mut held = [[0.0; D]; D];
        for i in 0..D {
            let mut power = [0.0; D];
            power[i] = 1.0;
            let mut integral_s = time_s;
            for term in 1..=TERMS {
                for row in 0..D {
                    state[i][row] += power[row];
                    held[i][row] += integral_s * power[row];
                }
                let next = combined(rates, &power);
                power = next.map(|x| x * time_s / f64::from(term));
                integral_s = time_s / f64::from(term + 1);
            }
        }
        Self {
            state,
            forces: inputs.map(|input| combined(&held, &input)),
        }
    }

    /// The map over twice the time.
    fn twice(&self) -> Self {
        let sum = |a: [f64; D], b: &[f64; D]| core::array::from_fn(|i| a[i] + b[i]);
        Self {
            state: self.state.map(|column| combined(&self.state, &column)),
            forces: self
                .forces
                .map(|column| sum(combined(&self.state, &column), &column)),
        }
    }

    /// The image of a state under forces.
    #[inline(always)]
    pub(super) fn of(&self, x: &[f64; D], forces: &[f64; S]) -> [f64; D] {
        let free = combined(&self.state, x);
        let forced = combined(&self.forces, forces);
        core::array::from_fn(|i| free[i] + forced[i])
    }
}

/// Sum of columns with these factors.
#[inline(always)]
pub(super) fn combined<const D: usize, const N: usize>(
    columns: &[[f64; D]; N],
    shares: &[f64; N],
) -> [f64; D] {
    let mut sum = [0.0; D];
    for (column, share) in columns.iter().zip(shares) {
        for (sum, x) in sum.iter_mut().zip(column) {
            *sum += share * x;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_response_of_a_damped_oscillator_matches_its_solution() {
        // x'' = f - 2 d x' - (d² + w²) x: x = f/(d² + w²) (1 - e^(-dt) (cos wt + d/w sin wt)) from rest.
        let (d, w, step_s) = (3.0f64, 40.0f64, 0.02f64);
        let square = d * d + w * w;
        let rates = [[0.0, -square], [1.0, -2.0 * d]];
        let hold = ZeroOrderHold::new(rates, [[0.0, 1.0]], step_s);
        for (map, t) in [(&hold.half, 0.5 * step_s), (&hold.whole, step_s)] {
            let [x, v] = map.of(&[0.0, 0.0], &[7.0]);
            let (sin, cos) = (w * t).sin_cos();
            let decay = (-d * t).exp();
            assert!((x - 7.0 / square * (1.0 - decay * (cos + d / w * sin))).abs() < 1e-13);
            assert!((v - 7.0 / w * decay * sin).abs() < 1e-11);
        }
        let [later, earlier] = [0.51, 0.49].map(|share| {
            let hold = ZeroOrderHold::new(rates, [[0.0, 1.0]], 2.0 * share * step_s);
            hold.half.of(&[0.0, 0.0], &[7.0])
        });
        let soon = hold.soon(&earlier, &[7.0], 0.02 * step_s);
        assert!((soon[0] - later[0]).abs() < 1e-7 && (soon[1] - later[1]).abs() < 1e-5);
    }
}
