//! Sums in the order in which `numpy` adds, because the rounding of a sum decides a verdict at its threshold and
//! `tools/score.py`, which defines the figures, adds with `numpy`.

/// Partial sums kept side by side in one block.
const LANES: usize = 8;
/// Longest run of values summed as one block.
const BLOCK: usize = 128;

/// Sum of `values` as `numpy.sum` of a one-dimensional array of doubles (pairwise summation).
pub(crate) fn sum(values: &[f64]) -> f64 {
    if values.len() < LANES {
        return values.iter().sum();
    }
    if values.len() > BLOCK {
        let half = values.len() / 2;
        let (left, right) = values.split_at(half - half % LANES);
        return sum(left) + sum(right);
    }
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut r = [0.0; LANES];
    for chunk in chunks {
        for (lane, x) in r.iter_mut().zip(chunk) {
            *lane += x;
        }
    }
    let block = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    rest.iter().fold(block, |total, x| total + x)
}

/// Mean of `values` as `numpy.mean`, or `None` of nothing.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| sum(values) / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn known_sums_of_numpy() {
        // numpy.sum of [0.1] * n; a sum from left to right differs in each.
        let tenths = |n| sum(&vec![0.1; n]);
        assert_eq!(tenths(10), 1.0);
        assert_eq!(tenths(45), 4.499999999999998);
        assert_eq!(tenths(300), 29.999999999999996);
        assert_eq!(tenths(1000), 100.00000000000001);
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(mean(&[]), None);
        assert_eq!(mean(&[1.0, 2.0]), Some(1.5));
    }

    /// Bit by bit the same. Needs a Python in `OBJECTHOOD_PYTHON`.
    #[test]
    fn sums_are_those_of_numpy() {
        let values: Vec<f64> = (1..2000).map(|k| 1.0 / f64::from(k)).collect();
        let lengths = (0..300).chain([1000, 1999]).collect::<Vec<usize>>();
        let script = "
import ast, sys, numpy
lengths = ast.literal_eval(sys.stdin.read())
values = 1.0 / numpy.arange(1, 2000)
for n in lengths:
    print(repr(float(values[:n].sum())))
";
        let Some(output) = crate::python::run(script, &format!("{lengths:?}")) else {
            println!("skipped: no Python with numpy (set OBJECTHOOD_PYTHON)");
            return;
        };
        let expected: Vec<f64> = output.lines().map(|line| line.parse().unwrap()).collect();
        let ours: Vec<f64> = lengths.iter().map(|&n| sum(&values[..n])).collect();
        assert_eq!(ours, expected);
    }

    proptest! {
        #[test]
        fn every_value_is_added_once(values in prop::collection::vec(-1000_i32..1000, 0..600)) {
            let exact: i32 = values.iter().sum();
            let floats: Vec<f64> = values.iter().map(|&x| f64::from(x)).collect();
            prop_assert_eq!(sum(&floats), f64::from(exact));
        }
    }
}
