//! Random numbers that are the same on every machine.

/// A linear congruential generator (Numerical Recipes). Its upper 24 bits are used.
pub(crate) struct Lcg {
    state: u32,
}

impl Lcg {
    /// The generator with this seed.
    pub(crate) fn new(seed: u32) -> Self {
        Self { state: seed }
    }

    /// A number in 0..n; n must not be 0. Slightly biased, as samples of a RANSAC may be.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.state >> 8) as usize % n
    }
}
