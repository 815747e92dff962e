//! One measured figure, and the line it is written as.

use std::fmt;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

/// A figure: `frame TAB series TAB value`. A series names what was measured, levels divided by `/`, and ends with the quantity:
/// `wall_ms`, `cpu_ms`, `allocations`, ..
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The frame it was measured on.
    pub frame: String,
    /// What was measured.
    pub series: String,
    /// How much.
    pub value: f64,
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\t{}\t{}", self.frame, self.series, self.value)
    }
}

/// Runs something and says how long it took on the clock and on the processor, of all threads together.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, Spent) {
    let start = Spent::now();
    let result = std::hint::black_box(work());
    (result, start.elapsed())
}

/// A moment on both clocks.
#[derive(Clone, Copy, Debug)]
pub struct Now {
    wall: Instant,
    cpu: ProcessTime,
}

/// Time on both clocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    /// On the wall.
    pub wall: Duration,
    /// On the processor, summed over the threads of the process.
    pub cpu: Duration,
}

impl Spent {
    /// The moment to count from.
    pub fn now() -> Now {
        Now { wall: Instant::now(), cpu: ProcessTime::now() }
    }

    /// A part of so many.
    #[must_use]
    pub fn over(self, count: usize) -> Self {
        let part = |time: Duration| time.div_f64(count.max(1) as f64);
        Self { wall: part(self.wall), cpu: part(self.cpu) }
    }

    /// As two figures: `series/wall_ms` and `series/cpu_ms`.
    pub fn figures(&self, frame: &str, series: &str) -> [Figure; 2] {
        let figure = |quantity, time: Duration| Figure {
            frame: frame.to_owned(),
            series: format!("{series}/{quantity}"),
            value: 1e3 * time.as_secs_f64(),
        };
        [figure("wall_ms", self.wall), figure("cpu_ms", self.cpu)]
    }
}

impl Now {
    /// What was spent since.
    pub fn elapsed(&self) -> Spent {
        Spent { wall: self.wall.elapsed(), cpu: self.cpu.elapsed() }
    }
}
