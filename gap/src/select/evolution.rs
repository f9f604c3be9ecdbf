//! Searches the lowest of many local optima by a simple evolution strategy (Rechenberg, 1973).

use host_sim::sensors::Noise;
use rayon::prelude::*;

/// Number of children per generation.
const CHILDREN: usize = 12;
/// Number of generations.
const GENERATIONS: usize = 8;
/// Factor on the spread of the children if none of them has a lower cost.
const NARROWER: f64 = 0.75;
const SEED: u64 = 0x6576_6f6c_7665;

/// Returns the lowest cost among `x` and its descendants, and the coordinates of that cost. The first children have a standard deviation of
/// `spread` in each coordinate.
pub(super) fn evolved(
    x: Vec<f64>,
    mut spread: f64,
    cost: impl Fn(&[f64]) -> f64 + Sync,
) -> (f64, Vec<f64>) {
    let mut noise = Noise::new(SEED);
    let mut best = (cost(&x), x);
    for _ in 0..GENERATIONS {
        let mut child = || best.1.iter().map(|x| x + noise.next(spread)).collect();
        let children: Vec<Vec<f64>> = (0..CHILDREN).map(|_| child()).collect();
        let costs = children.into_par_iter().map(|x| (cost(&x), x));
        match costs.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some(child) if child.0 < best.0 => best = child,
            _ => spread *= NARROWER,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_of_many_optima_is_approached() {
        // Gradients lead to the nearest optimum. The optima are about one unit apart.
        let rugged = |x: &[f64]| {
            let ripples = x.iter().map(|x| x * x + 0.5 * (1.0 - (6.0 * x).cos()));
            ripples.sum::<f64>()
        };
        let start = vec![1.9, -1.2, 0.9];
        let before = rugged(&start);
        let (after, x) = evolved(start, 0.5, rugged);
        assert!(after < 0.1 * before, "{after} of {before} at {x:?}");
        assert!((after - rugged(&x)).abs() < f64::EPSILON);
    }

    #[test]
    fn the_start_is_kept_if_it_is_the_optimum() {
        let (cost, x) = evolved(vec![0.0; 2], 0.5, |x| x.iter().map(|x| x.abs()).sum());
        assert_eq!((cost, x), (0.0, vec![0.0; 2]));
    }
}
