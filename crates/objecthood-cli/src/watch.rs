//! How long the stages of a frame take.

use std::fmt;
use std::time::{Duration, Instant};

use objecthood::{Observer, Output};

/// The times of what is done one after the other.
pub(crate) struct Laps {
    start: Instant,
    laps: Vec<(&'static str, Duration)>,
}

impl Laps {
    /// Begins the first lap.
    pub(crate) fn start() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }

    /// Ends a lap: what was done since the last one is `name`.
    pub(crate) fn end(&mut self, name: &'static str) {
        self.laps.push((name, self.start.elapsed()));
        self.start = Instant::now();
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

/// Takes the time of every stage and passes the stage on.
pub(crate) struct Watch<'a> {
    /// Where the times go.
    pub(crate) laps: &'a mut Laps,
    /// Who sees the stages next; what that takes is nobody's time.
    pub(crate) next: &'a mut dyn Observer,
}

impl Observer for Watch<'_> {
    fn observe(&mut self, output: Output<'_>) {
        self.laps.end(output.stage().name());
        self.next.observe(output);
        self.laps.start = Instant::now();
    }
}
