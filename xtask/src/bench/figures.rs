//! What was measured: every figure by the name of its series, and what is said of a series.

use std::collections::BTreeMap;
use std::fmt;

use anyhow::{Context, Result};

/// The values of every series.
#[derive(Debug, Default)]
pub(crate) struct Figures {
    series: BTreeMap<String, Vec<f64>>,
}

/// The middle of a series and of its halves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) low: f64,
    pub(crate) median: f64,
    pub(crate) high: f64,
}

impl fmt::Display for Spread {
    /// With as many digits as are asked for, two without.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let Self { low, median, high } = self;
        write!(f, "{median:.digits$} ({low:.digits$} .. {high:.digits$})")
    }
}

impl Figures {
    /// Adds a value to a series.
    pub(crate) fn add(&mut self, series: impl Into<String>, value: f64) {
        self.series.entry(series.into()).or_default().push(value);
    }

    /// Takes in what `measure` printed, lines of `frame TAB series TAB value`; `name` makes the name of a series from frame and
    /// series.
    ///
    /// # Errors
    /// When a line is something else.
    pub(crate) fn read(&mut self, text: &str, name: impl Fn(&str, &str) -> String) -> Result<()> {
        for line in text.lines() {
            let parts: Vec<&str> = line.split('\t').collect();
            let [frame, series, value] = parts[..] else { anyhow::bail!("no figure: {line}") };
            self.add(name(frame, series), value.parse().with_context(|| format!("no figure: {line}"))?);
        }
        Ok(())
    }

    /// Median and quartiles; none when nothing was measured.
    pub(crate) fn spread(&self, series: &str) -> Option<Spread> {
        let mut values = self.series.get(series)?.clone();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
        Some(Spread { low: at(0.25), median: at(0.5), high: at(0.75) })
    }

    /// The median; none when nothing was measured.
    pub(crate) fn median(&self, series: &str) -> Option<f64> {
        self.spread(series).map(|spread| spread.median)
    }

    /// How often a series was measured.
    pub(crate) fn count(&self, series: &str) -> usize {
        self.series.get(series).map_or(0, Vec::len)
    }

    /// The names of the series that begin and end like this, without both ends, in the order of the alphabet.
    pub(crate) fn between<'a>(&'a self, start: &'a str, end: &'a str) -> impl Iterator<Item = &'a str> {
        self.series.keys().filter_map(move |name| name.strip_prefix(start)?.strip_suffix(end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_quartiles_of_what_was_printed() {
        let mut figures = Figures::default();
        let lines: String = [9.0, 1.0, 5.0, 3.0, 7.0].map(|v| format!("learn0\ta/cpu_ms\t{v}\n")).concat();
        figures.read(&lines, |_, series| series.to_owned()).unwrap();
        assert_eq!(figures.spread("a/cpu_ms"), Some(Spread { low: 3.0, median: 5.0, high: 7.0 }));
        assert_eq!(format!("{:.1}", figures.spread("a/cpu_ms").unwrap()), "5.0 (3.0 .. 7.0)");
        assert_eq!((figures.count("a/cpu_ms"), figures.median("b")), (5, None));
        assert_eq!(figures.between("", "/cpu_ms").collect::<Vec<_>>(), ["a"]);
        assert!(figures.read("a line\n", |_, series| series.to_owned()).is_err());
    }
}
