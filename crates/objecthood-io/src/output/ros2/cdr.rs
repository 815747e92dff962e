//! CDR, the encoding of ROS 2 messages: little-endian, each number at a multiple of its size behind the first four bytes.

/// A message in the making.
pub(super) struct Cdr(Vec<u8>);

/// Says that what follows is plain CDR, little-endian.
const HEAD: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    pub(super) fn new() -> Self {
        Self(HEAD.to_vec())
    }

    fn align(&mut self, size: usize) {
        let length = (self.0.len() - HEAD.len()).next_multiple_of(size) + HEAD.len();
        self.0.resize(length, 0);
    }

    pub(super) fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub(super) fn bool(&mut self, value: bool) {
        self.u8(value.into());
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// Numbers in a row, whose count the reader knows.
    pub(super) fn f64s(&mut self, values: &[f64]) {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }

    /// How many elements a sequence has; they follow.
    pub(super) fn count(&mut self, count: usize) {
        self.u32(count as u32);
    }

    pub(super) fn string(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// A sequence of bytes.
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.0.extend(bytes);
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }
}
