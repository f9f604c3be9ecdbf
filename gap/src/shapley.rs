//! What each of several causes accounts for that close a gap together.

/// Causes of which every subset is looked at; of more, each is taken alone and left out.
const MOST_SUBSETS: usize = 4;
/// Share of what all close that a cause closes alone at least, where it closes less: two that cancel close nothing alone, and one of
/// them comes first all the same.
const LEAST_ALONE: f64 = 0.05;

/// What a cause accounts for of what all close together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// Its Shapley share (Shapley, Contributions to the Theory of Games 2, 1953), over the subsets that are looked at.
    pub of_all: f64,
    /// What it closes alone, over what all do.
    pub alone: f64,
}

impl Share {
    /// By which causes are ordered: Shapley share times what it closes alone.
    pub(crate) fn rank(self) -> f64 {
        self.of_all * self.alone.max(LEAST_ALONE)
    }
}

/// The subsets of `count` causes that their shares are made from, one bit a cause.
pub(crate) fn subsets(count: usize) -> Vec<u32> {
    let all = (1u32 << count) - 1;
    let is_needed = |subset: &u32| {
        let size = subset.count_ones() as usize;
        count <= MOST_SUBSETS || size <= 1 || size >= count - 1
    };
    (0..=all).filter(is_needed).collect()
}

/// The shares of `count` causes, where so much is `left` of a gap with each of their [`subsets`].
pub(crate) fn shares(count: usize, left: &[(u32, f64)]) -> Vec<Share> {
    let all = (1u32 << count) - 1;
    let closed = |subset: u32| {
        let of = |wanted| {
            left.iter()
                .find(|(s, _)| *s == wanted)
                .map(|(_, left)| *left)
        };
        Some(of(0)? - of(subset)?)
    };
    let whole = closed(all).unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let share = |cause: usize| {
        let own = 1 << cause;
        let mut sum = 0.0;
        let mut weights = 0.0;
        for (subset, _) in left.iter().filter(|(s, _)| s & own == 0) {
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
    fn causes_that_close_independently_account_for_what_each_closes() {
        let closes = [0.5, 0.3, 0.1, 0.05, 0.05];
        for count in [2, 5] {
            let whole: f64 = closes[..count].iter().sum();
            let left = |subset: u32| {
                let taken = (0..count).filter(|cause| subset >> cause & 1 == 1);
                1.0 - taken.map(|cause| closes[cause]).sum::<f64>()
            };
            let left: Vec<(u32, f64)> = subsets(count).into_iter().map(|s| (s, left(s))).collect();
            for (share, closes) in shares(count, &left).iter().zip(closes) {
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
    fn of_two_that_do_the_same_each_accounts_for_half() {
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
