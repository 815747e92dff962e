//! The assignment of the tracker, checked by force and against `scipy`.

pub(crate) use objecthood_track::assignment::maximize;

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
