//! Reduces the number of points without a visible difference.

/// Divides `[from, to]` into `columns` equal columns. Returns the first, lowest, highest and last point of each column, in
/// the order of the data. Points outside the range and points that are not finite are left out.
pub fn envelope(points: &[(f64, f64)], [from, to]: [f64; 2], columns: usize) -> Vec<(f64, f64)> {
    let column = |x: f64| ((x - from) / (to - from) * columns as f64) as usize;
    let inside: Vec<_> = points
        .iter()
        .copied()
        .filter(|(x, y)| (from..=to).contains(x) && y.is_finite())
        .collect();
    let mut kept = Vec::with_capacity(inside.len().min(4 * columns));
    for run in inside.chunk_by(|a, b| column(a.0) == column(b.0)) {
        let by_height = |a: &usize, b: &usize| run[*a].1.total_cmp(&run[*b].1);
        let lowest = (0..run.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..run.len()).max_by(by_height).unwrap_or(0);
        let mut places = [0, lowest, highest, run.len() - 1];
        places.sort_unstable();
        for (i, &place) in places.iter().enumerate() {
            if i == 0 || places[i - 1] != place {
                kept.push(run[place]);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_is_kept_and_the_number_of_points_is_bounded() {
        let mut points: Vec<_> = (0..100_000).map(|i| (f64::from(i), 0.0)).collect();
        points[54_321].1 = 7.0;
        let thin = envelope(&points, [0.0, 99_999.0], 500);
        assert!(thin.contains(&(54_321.0, 7.0)));
        assert!(thin.len() <= 4 * 501);
        assert_eq!((thin[0], thin[thin.len() - 1]), (points[0], points[99_999]));
    }

    #[test]
    fn points_that_are_not_finite_are_left_out() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)];
        assert_eq!(envelope(&points, [0.0, 2.0], 10), [(0.0, 1.0), (2.0, 3.0)]);
    }
}
