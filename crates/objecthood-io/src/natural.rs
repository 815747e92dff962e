//! The order in which people count: `learn2` before `learn10`.

use std::cmp::Ordering;
use std::ffi::OsStr;

/// Compares two names with every run of digits taken as one number; names that only differ in leading zeros come in
/// the order of their bytes.
pub fn compare(a: &OsStr, b: &OsStr) -> Ordering {
    let (a, b) = (a.as_encoded_bytes(), b.as_encoded_bytes());
    runs(a).map(key).cmp(runs(b).map(key)).then_with(|| a.cmp(b))
}

/// The runs of digits and of other bytes that make up a name.
fn runs(name: &[u8]) -> impl Iterator<Item = &[u8]> {
    name.chunk_by(|x, y| x.is_ascii_digit() == y.is_ascii_digit())
}

/// Digits come before other bytes, and a number with more digits is greater.
fn key(run: &[u8]) -> (bool, usize, &[u8]) {
    if run[0].is_ascii_digit() {
        let zeros = run.iter().take_while(|&&digit| digit == b'0').count();
        (false, run.len() - zeros, &run[zeros..])
    } else {
        (true, 0, run)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_counted() {
        let mut names =
            ["b1", "a10.pcd", "a9.pcd", "a", "a010.pcd", "a9b2", "10", "9", "a99999999999999999999999"];
        names.sort_by(|a, b| compare(OsStr::new(a), OsStr::new(b)));
        let sorted =
            ["9", "10", "a", "a9.pcd", "a9b2", "a010.pcd", "a10.pcd", "a99999999999999999999999", "b1"];
        assert_eq!(names, sorted);
    }

    #[test]
    fn different_names_are_never_equal() {
        assert_eq!(compare(OsStr::new("a0"), OsStr::new("a00")), Ordering::Less);
        assert_eq!(compare(OsStr::new("a0"), OsStr::new("a0")), Ordering::Equal);
    }
}
