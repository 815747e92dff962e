//! Loops over pixels, compiled for the vector units of the machine.

/// Runs `work`, which is compiled once for each width of vectors. The machine chooses at run time.
///
/// The result is the same for all widths, to the bit: Rust neither contracts nor reorders floating-point operations. Functions called
/// by `work` have to be inlined into it, else they are compiled for the smallest width only. With the feature `scalar` there is no
/// choice at run time, so that instruction counts can be compared between machines.
#[inline(always)]
pub(crate) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    if cfg!(feature = "scalar") { work() } else { pulp::Arch::new().dispatch(work) }
}

/// Appends the marked values, at most N, in their order. It has no branch, which pays when a processor cannot predict the marks.
/// Panics when a value follows after N marked ones.
pub(crate) fn extend_where<const N: usize, T: Copy + Default>(
    all: &mut Vec<T>,
    values: impl Iterator<Item = (T, bool)>,
) {
    let (mut kept, mut count) = ([T::default(); N], 0);
    for (value, is_marked) in values {
        kept[count] = value;
        count += usize::from(is_marked);
    }
    all.extend_from_slice(&kept[..count]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_values_are_added_in_their_order() {
        for marks in 0..1 << 5 {
            let values = || (0..5).map(|k| (k, marks >> k & 1 == 1));
            let mut all = vec![7];
            extend_where::<5, _>(&mut all, values());
            let kept = values().filter(|value| value.1).map(|value| value.0);
            assert_eq!(all, [7].into_iter().chain(kept).collect::<Vec<_>>());
        }
    }
}
