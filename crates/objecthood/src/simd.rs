//! Loops over pixels without branches, compiled for the vector units that the machine has.

/// Runs `work`, which is compiled once for every width of vectors; which one runs the machine decides.
///
/// The result is the same with all of them, and without: Rust neither contracts nor reorders floating-point operations.
/// What `work` calls has to be inlined into it, else it is compiled for the smallest machine only. With the feature
/// `scalar` nothing is chosen at run time, so that instructions can be counted and compared between machines.
#[inline(always)]
pub(crate) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    if cfg!(feature = "scalar") { work() } else { pulp::Arch::new().dispatch(work) }
}

/// Adds the marked ones of at most N values in their order, without branches: where none can foresee which they are. Panics when
/// values come after N marked ones.
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
