//! Determinants without division. The method also works for singular matrices, and for matrices of intervals that
//! contain 0.

use dalembert_expr::Arithmetic;

/// Largest number of rows of an expanded determinant.
pub(super) const LARGEST: usize = 14;

/// Determinant of a square matrix, by expansion into the minors of its first rows; `None` if the matrix is too large.
pub(super) fn determinant<A: Arithmetic>(field: A, rows: &[Vec<A::Scalar>]) -> Option<A::Scalar> {
    let n = rows.len();
    if n > LARGEST {
        return None;
    }
    // `minors[set]` is the minor of the columns in `set` (a bit mask) and of as many first rows.
    let mut minors = vec![field.integer(0); 1 << n];
    minors[0] = field.integer(1);
    for set in 1_usize..1 << n {
        let last = set.count_ones() as usize - 1;
        let mut sum = field.integer(0);
        for column in (0..n).filter(|column| set >> column & 1 == 1) {
            let term = field.mul(rows[last][column], minors[set ^ (1 << column)]);
            let behind = (set >> column >> 1).count_ones();
            sum = match behind % 2 {
                0 => field.add(sum, term),
                _ => field.sub(sum, term),
            };
        }
        minors[set] = sum;
    }
    Some(minors[(1 << n) - 1])
}

#[cfg(test)]
mod tests {
    use dalembert_expr::Reals;

    use super::*;

    #[test]
    fn determinants_are_those_of_elimination() {
        let rows = [
            vec![2.0, -1.0, 3.0],
            vec![4.0, 5.0, -2.0],
            vec![1.0, 7.0, 6.0],
        ];
        assert_eq!(determinant(Reals, &rows), Some(183.0));
        assert_eq!(determinant(Reals, &[]), Some(1.0));
        assert_eq!(
            determinant(Reals, &[vec![0.0, 2.0], vec![3.0, 0.0]]),
            Some(-6.0)
        );
        assert_eq!(
            determinant(Reals, &[vec![1.0, 2.0], vec![2.0, 4.0]]),
            Some(0.0)
        );
        assert_eq!(determinant(Reals, &vec![vec![0.0; 20]; 20]), None);
    }
}
