//! How long each stage of a frame takes.

use std::fmt;
use std::time::{Duration, Instant};

use objecthood::{Observer, Output};

/// The durations of consecutive steps.
pub(crate) struct Laps {
    start: Instant,
    laps: Vec<(&'static str, Duration)>,
}

impl Laps {
    /// Starts the clock.
    pub(crate) fn start() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }

    /// Ends a step: the time since the last one ended belongs to `name`.
    pub(crate) fn end(&mut self, name: &'static str) {
        self.laps.push((name, self.start.elapsed()));
        self.start = Instant::now();
    }

    /// The steps that have ended, each with its duration (ms).
    pub(crate) fn ended_ms(&self) -> Vec<(&'static str, f64)> {
        self.laps.iter().map(|&(name, time)| (name, 1e3 * time.as_secs_f64())).collect()
    }
}

impl fmt::Display for Laps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |time: Duration| 1e3 * time.as_secs_f64();
        for &(name, time) in &self.laps {
            write!(f, "{name} {:.1} ms, ", ms(time))?;
        }
        write!(f, "together {:.1} ms", ms(self.laps.iter().map(|lap| lap.1).sum()))
    }
}

/// Measures the time of every stage, then hands the stage on.
pub(crate) struct Watch<'a> {
    /// Collects the durations.
    pub(crate) laps: &'a mut Laps,
    /// Sees the stages next; its own time is not counted.
    pub(crate) next: &'a mut dyn Observer,
}

impl Observer for Watch<'_> {
    fn observe(&mut self, output: Output<'_>) {
        self.laps.end(output.stage().name());
        self.next.observe(output);
        self.laps.start = Instant::now();
    }
}
