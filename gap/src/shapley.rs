//! Shapley shares of several causes that close a gap together.

/// Largest number of causes of which all subsets are evaluated. Of more causes, only the single ones and those without one are evaluated.
const MOST_SUBSETS: usize = 4;
/// Least share that a cause closes alone, for the order of the causes. Two causes that compensate each other close nothing alone, but one
/// of them must come first.
const LEAST_ALONE: f64 = 0.05;

/// The share of one cause in the total closing of all causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// Shapley share (Shapley, Contributions to the Theory of Games 2, 1953), over the evaluated subsets.
    pub of_all: f64,
    /// Closing by this cause alone, over that by all causes.
    pub alone: f64,
}

impl Share {
    /// Sort key of the causes: the Shapley share times the share alone.
    pub(crate) fn rank(self) -> f64 {
        self.of_all * self.alone.max(LEAST_ALONE)
    }
}

/// The evaluated subsets of `count` causes, one bit per cause.
pub(crate) fn subsets(count: usize) -> Vec<u32> {
    let all = (1u32 << count) - 1;
    let is_needed = |subset: &u32| {
        let size = subset.count_ones() as usize;
        count <= MOST_SUBSETS || size <= 1 || size >= count - 1
    };
    (0..=all).filter(is_needed).collect()
}

/// The shares of `count` causes. `gaps` holds the remaining gap of each of their [`subsets`].
pub(crate) fn shares(count: usize, gaps: &[(u32, f64)]) -> Vec<Share> {
    let all = (1u32 << count) - 1;
    let closed = |subset: u32| {
        let of = |wanted| gaps.iter().find(|(s, _)| *s == wanted).map(|(_, gap)| *gap);
        Some(of(0)? - of(subset)?)
    };
    let whole = closed(all).unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let share = |cause: usize| {
        let own = 1 << cause;
        let mut sum = 0.0;
        let mut weights = 0.0;
        for (subset, _) in gaps.iter().filter(|(s, _)| s & own == 0) {
            let (Some(with), Some(without)) = (closed(subset | own), closed(*subset)) else {
                continue;
            };
            let weight = weight(subset.count_ones() as usize, count);
            sum += weight * (with - without);
            weights += weight;
        }
        Share {
            of_all: sum / weights.max(f64::MIN_POSITIVE) / whole,
            alone: closed(own).unwrap_or(0.0) / whole,
        }
    };
    (0..count).map(share).collect()
}

/// `size! (count − size − 1)! / count!`.
fn weight(size: usize, count: usize) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    factorial(size) * factorial(count - size - 1) / factorial(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn independent_causes_have_the_shares_that_they_close() {
        let closes = [0.5, 0.3, 0.1, 0.05, 0.05];
        for count in [2, 5] {
            let whole: f64 = closes[..count].iter().sum();
            let gaps = |subset: u32| {
                let included = (0..count).filter(|cause| subset >> cause & 1 == 1);
                1.0 - included.map(|cause| closes[cause]).sum::<f64>()
            };
            let gaps: Vec<(u32, f64)> = subsets(count).into_iter().map(|s| (s, gaps(s))).collect();
            for (share, closes) in shares(count, &gaps).iter().zip(closes) {
                let expected = closes / whole;
                assert!(
                    (share.of_all - expected).abs() < 1e-12,
                    "{share:?} {expected}"
                );
                assert!(
                    (share.alone - expected).abs() < 1e-12,
                    "{share:?} {expected}"
                );
            }
        }
    }

    #[test]
    fn two_equal_causes_have_equal_shares() {
        let shares = shares(2, &[(0b00, 1.0), (0b01, 0.2), (0b10, 0.2), (0b11, 0.2)]);
        assert!(
            shares
                .iter()
                .all(|share| (share.of_all - 0.5).abs() < 1e-12),
            "{shares:?}"
        );
        assert!(
            shares.iter().all(|share| (share.alone - 1.0).abs() < 1e-12),
            "{shares:?}"
        );
    }
}
