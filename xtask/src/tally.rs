//! What the test runner's output says: counts, closing lines, and what was skipped.

/// Sums over all test programs of a run.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    /// Tests that did not run, each with the reason.
    pub(crate) skipped: Vec<String>,
    /// The closing line of every test program, as it stood.
    pub(crate) closing_lines: Vec<String>,
}

impl Tally {
    /// Takes in the next line of output.
    pub(crate) fn read(&mut self, line: &str) {
        let line = line.trim_end();
        if let Some(why) = line.strip_prefix("skipped: ") {
            self.skip(why.to_owned());
        } else if let Some((test, why)) = ignored(line) {
            self.skip(format!("{test}: ignored{why}"));
        } else if line.starts_with("test result: ") {
            self.passed += count(line, "passed");
            self.failed += count(line, "failed");
            self.closing_lines.push(line.to_owned());
        } else if let Some(why) = line.strip_prefix("SKIPPED ") {
            self.skip(why.to_owned());
        } else if is_closing_line_of_pytest(line) {
            self.passed += count(line, "passed");
            self.failed += count(line, "failed") + count(line, "errors") + count(line, "error");
            self.closing_lines.push(line.to_owned());
        }
    }

    /// Notes that something was skipped; what several tests say is noted once.
    pub(crate) fn skip(&mut self, why: String) {
        if !self.skipped.contains(&why) {
            self.skipped.push(why);
        }
    }
}

/// The name of an ignored test and the reason, if `line` reports one: `test NAME ... ignored, REASON`.
fn ignored(line: &str) -> Option<(&str, &str)> {
    line.strip_prefix("test ")?.split_once(" ... ignored")
}

/// Whether a line is as `3 failed, 75 passed, 1 skipped in 20.93s`, which `pytest -q` prints last.
fn is_closing_line_of_pytest(line: &str) -> bool {
    let Some((counts, seconds)) = line.rsplit_once(" in ") else { return false };
    let is_count = |part: &str| part.split_once(' ').is_some_and(|(number, _)| number.parse::<u64>().is_ok());
    seconds.starts_with(|c: char| c.is_ascii_digit()) && counts.split(", ").all(is_count)
}

/// The number before `word` in `test result: ok. 3 passed; 0 failed; ..`, or between commas.
fn count(line: &str, word: &str) -> u64 {
    let words: Vec<&str> = line.split([' ', ';', ',']).filter(|w| !w.is_empty()).collect();
    words.windows(2).find(|pair| pair[1] == word).and_then(|pair| pair[0].parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_skips_are_read_off_the_runners_lines() {
        let mut tally = Tally::default();
        for line in [
            "running 3 tests",
            "test a::b ... ok",
            "test a::c ... ignored, takes an hour",
            "skipped: no data folder",
            "skipped: no data folder",
            "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s",
            "test result: FAILED. 2 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s",
            "SKIPPED [1] tests/test_files.py:12: no images",
            "1 failed, 75 passed, 1 skipped, 1 error in 20.93s",
            "5 lines were printed in vain",
        ] {
            tally.read(line);
        }
        assert_eq!((tally.passed, tally.failed), (89, 5));
        assert_eq!(
            tally.skipped,
            ["a::c: ignored, takes an hour", "no data folder", "[1] tests/test_files.py:12: no images"]
        );
        assert_eq!(tally.closing_lines.len(), 3);
    }
}
