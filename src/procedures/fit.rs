//! Small least-squares problems.

/// Least-squares coefficients of `columns` for `values`, by the modified Gram-Schmidt method (Golub and Van Loan, Matrix
/// Computations, section 5.2.8). Returns `None` if the columns are linearly dependent.
pub fn least_squares<const ROWS: usize, const COLUMNS: usize>(
    mut columns: [[f32; ROWS]; COLUMNS],
    mut values: [f32; ROWS],
) -> Option<[f32; COLUMNS]> {
    /// Least share of a column's squared norm that must be orthogonal to the previous columns.
    const OWN_SHARE: f32 = 1e-8;
    let mut upper = [[0.0; COLUMNS]; COLUMNS];
    let mut solution = [0.0; COLUMNS];
    for place in 0..COLUMNS {
        let (done, rest) = columns.split_at_mut(place);
        let (column, later) = rest.split_first_mut()?;
        let _ = done;
        let length = dot(column, column);
        if length.is_nan() || length <= 0.0 {
            return None;
        }
        for (offset, other) in later.iter_mut().enumerate() {
            let before = dot(other, other);
            let share = dot(column, other) / length;
            *upper.get_mut(place)?.get_mut(place + 1 + offset)? = share;
            take_away(other, column, share);
            if dot(other, other) <= OWN_SHARE * before {
                return None;
            }
        }
        let share = dot(column, &values) / length;
        *solution.get_mut(place)? = share;
        take_away(&mut values, column, share);
    }
    for place in (0..COLUMNS).rev() {
        let later: f32 = (place + 1..COLUMNS)
            .map(|other| {
                let share = upper.get(place).and_then(|row| row.get(other));
                share.unwrap_or(&0.0) * solution.get(other).unwrap_or(&0.0)
            })
            .sum();
        *solution.get_mut(place)? -= later;
    }
    solution
        .iter()
        .all(|value| value.is_finite())
        .then_some(solution)
}

fn dot<const ROWS: usize>(a: &[f32; ROWS], b: &[f32; ROWS]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn take_away<const ROWS: usize>(from: &mut [f32; ROWS], column: &[f32; ROWS], share: f32) {
    for (value, part) in from.iter_mut().zip(column) {
        *value -= share * part;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_of_a_cubic_are_found() {
        let at: [f32; 20] = core::array::from_fn(|row| row as f32 * 0.1 - 1.0);
        let truth = [0.3, -2.0, 0.5, 4.0];
        let values = at.map(|x| truth[0] + x * (truth[1] + x * (truth[2] + x * truth[3])));
        let columns = [
            at.map(|_| 1.0),
            at,
            at.map(|x| x * x),
            at.map(|x| x * x * x),
        ];
        let found = least_squares(columns, values).unwrap();
        for (found, truth) in found.iter().zip(truth) {
            assert!((found - truth).abs() < 1e-4, "{found} {truth}");
        }
    }

    #[test]
    fn linearly_dependent_columns_have_no_solution() {
        assert_eq!(least_squares([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0]), None);
        assert_eq!(least_squares([[0.0, 0.0]], [1.0, 1.0]), None);
    }
}
