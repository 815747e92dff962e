//! The best one-to-one assignment of rows to columns (rectangular linear sum assignment).
//!
//! Shortest augmenting paths with dual variables: each row in turn enters the assignment along the path that
//! costs least (D. F. Crouse, "On implementing 2D rectangular assignment algorithms", IEEE TAES 52(4), 2016).
//! O(r²·c) for the smaller side r and the larger side c.
//!
//! Among several best assignments the one of `scipy.optimize.linear_sum_assignment` is taken, because equal
//! values with unequal overlaps would otherwise change a printed digit: the open columns are searched in the same
//! order, and of equally near columns an unassigned one wins.

/// The assignment of as many pairs as the smaller side has that maximises the sum of `values` (row-major,
/// `rows` x `columns`, finite). Pairs (row, column) by ascending row.
pub(crate) fn maximize(values: &[f64], rows: usize, columns: usize) -> Vec<(usize, usize)> {
    debug_assert_eq!(values.len(), rows * columns);
    debug_assert!(values.iter().all(|x| x.is_finite()));
    if rows > columns {
        let transposed: Vec<f64> =
            (0..columns).flat_map(|c| (0..rows).map(move |r| values[r * columns + c])).collect();
        let mut pairs: Vec<_> =
            maximize(&transposed, columns, rows).into_iter().map(|(c, r)| (r, c)).collect();
        pairs.sort_unstable();
        return pairs;
    }

    let mut row_price = vec![0.0; rows];
    let mut column_price = vec![0.0; columns];
    let mut column_of = vec![0; rows];
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    // Of the search: how far each column is from the row that enters, and the row before it on that path.
    let mut distance = vec![0.0; columns];
    let mut row_before = vec![0; columns];
    let mut reached = Vec::with_capacity(columns);

    for entering in 0..rows {
        distance.fill(f64::INFINITY);
        reached.clear();
        let mut open: Vec<usize> = (0..columns).rev().collect();
        let (mut row, mut walked) = (entering, 0.0);
        let sink = loop {
            let (mut nearest, mut place) = (f64::INFINITY, 0);
            for (k, &column) in open.iter().enumerate() {
                let through = walked - values[row * columns + column] - row_price[row] - column_price[column];
                if through < distance[column] {
                    distance[column] = through;
                    row_before[column] = row;
                }
                let here = distance[column];
                if here < nearest || (here == nearest && row_of[column].is_none()) {
                    (nearest, place) = (here, k);
                }
            }
            walked = nearest;
            let column = open.swap_remove(place);
            reached.push(column);
            match row_of[column] {
                Some(next) => row = next,
                None => break column,
            }
        };

        row_price[entering] += walked;
        for &column in &reached {
            let slack = walked - distance[column];
            column_price[column] -= slack;
            if let Some(row) = row_of[column] {
                row_price[row] += slack;
            }
        }

        let mut column = sink;
        loop {
            let row = row_before[column];
            row_of[column] = Some(row);
            let freed = std::mem::replace(&mut column_of[row], column);
            if row == entering {
                break;
            }
            column = freed;
        }
    }
    column_of.into_iter().enumerate().collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::strategy::ValueTree;

    use super::*;

    /// The greatest sum over all assignments, by trying them all.
    fn best_by_force(values: &[f64], rows: usize, columns: usize) -> f64 {
        fn place(values: &[f64], columns: usize, row: usize, rows: usize, to_skip: usize, used: u32) -> f64 {
            if row == rows {
                return 0.0;
            }
            let skipped = if to_skip > 0 {
                place(values, columns, row + 1, rows, to_skip - 1, used)
            } else {
                f64::NEG_INFINITY
            };
            (0..columns).filter(|c| used & (1 << c) == 0).fold(skipped, |best, c| {
                let rest = place(values, columns, row + 1, rows, to_skip, used | (1 << c));
                best.max(values[row * columns + c] + rest)
            })
        }
        place(values, columns, 0, rows, rows.saturating_sub(columns), 0)
    }

    fn check(values: &[f64], rows: usize, columns: usize) {
        let pairs = maximize(values, rows, columns);
        assert_eq!(pairs.len(), rows.min(columns));
        assert!(pairs.windows(2).all(|w| w[0].0 < w[1].0), "ascending rows: {pairs:?}");
        let mut used: Vec<_> = pairs.iter().map(|p| p.1).collect();
        used.sort_unstable();
        used.dedup();
        assert_eq!(used.len(), pairs.len(), "a column twice: {pairs:?}");
        let sum: f64 = pairs.iter().map(|&(r, c)| values[r * columns + c]).sum();
        let best = best_by_force(values, rows, columns);
        assert!((sum - best).abs() < 1e-9, "{sum} but {best} is possible with {values:?} {rows}x{columns}");
    }

    fn matrix(value: impl Strategy<Value = f64>) -> impl Strategy<Value = (Vec<f64>, usize, usize)> {
        (0_usize..6, 0_usize..6, prop::collection::vec(value, 25))
            .prop_map(|(rows, columns, values)| (values[..rows * columns].to_vec(), rows, columns))
    }

    proptest! {
        #[test]
        fn no_assignment_is_better((values, rows, columns) in matrix(-1.0..1.0)) {
            check(&values, rows, columns);
        }

        #[test]
        fn no_assignment_is_better_with_many_ties((values, rows, columns) in matrix((0_u8..3).prop_map(f64::from))) {
            check(&values, rows, columns);
        }
    }

    #[test]
    fn equal_values_assign_in_order() {
        for n in 1..5 {
            let identity: Vec<_> = (0..n).map(|i| (i, i)).collect();
            assert_eq!(maximize(&vec![0.25; n * n], n, n), identity);
            assert_eq!(maximize(&vec![0.0; n * (n + 2)], n, n + 2), identity);
            assert_eq!(maximize(&vec![0.0; n * (n + 2)], n + 2, n), identity);
        }
    }

    /// The same pairs as `scipy`, where many assignments are best. Needs a Python in `OBJECTHOOD_PYTHON`.
    #[test]
    fn ties_are_broken_as_in_scipy() {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let cases: Vec<_> = (0..2000)
            .map(|_| {
                matrix((0_u8..4).prop_map(|x| f64::from(x) / 3.0)).new_tree(&mut runner).unwrap().current()
            })
            .filter(|(values, ..)| !values.is_empty())
            .collect();
        let input: String = cases.iter().map(|case| format!("{case:?}\n")).collect();
        let script = "
import ast, sys, numpy
from scipy.optimize import linear_sum_assignment
for line in sys.stdin:
    values, rows, columns = ast.literal_eval(line)
    r, c = linear_sum_assignment(-numpy.array(values).reshape(rows, columns))
    print([(int(a), int(b)) for a, b in zip(r, c)])
";
        let Some(output) = crate::python::run(script, &input) else {
            println!("skipped: no Python with numpy and scipy (set OBJECTHOOD_PYTHON)");
            return;
        };
        assert_eq!(output.lines().count(), cases.len());
        for ((values, rows, columns), expected) in cases.iter().zip(output.lines()) {
            let pairs = maximize(values, *rows, *columns);
            assert_eq!(format!("{pairs:?}"), expected, "{values:?} {rows}x{columns}");
        }
    }

    #[test]
    fn nothing_to_assign() {
        assert_eq!(maximize(&[], 0, 3), []);
        assert_eq!(maximize(&[], 3, 0), []);
    }
}
