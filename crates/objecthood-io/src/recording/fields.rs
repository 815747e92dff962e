//! The fields of a ROS message, one after the other.
//!
//! ROS 2 writes CDR: four bytes that say the order of bytes, then fields that stand at multiples of their size. ROS 1 writes
//! the same fields without gaps, in little-endian order. Sources: OMG DDS-XTypes 1.3, 7.4.1 (CDR); the ROS 1 wiki,
//! `msg`.

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wire {
    /// ROS 2.
    Cdr,
    /// ROS 1.
    Ros1,
}

/// The fields that are left of a message.
#[derive(Clone)]
pub(crate) struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
    wire: Wire,
    is_big_endian: bool,
}

/// Why a message has not the fields that it should have.
pub(crate) type Problem = String;

impl<'a> Fields<'a> {
    /// All fields of a message.
    ///
    /// # Errors
    /// When it does not say its order of bytes.
    pub(crate) fn of(message: &'a [u8], wire: Wire) -> Result<Self, Problem> {
        let (bytes, is_big_endian) = match (wire, message) {
            (Wire::Ros1, _) => return Ok(Self::packed(message)),
            (Wire::Cdr, [0, order @ (0 | 1), _, _, bytes @ ..]) => (bytes, *order == 0),
            (Wire::Cdr, _) => return Err("it does not begin as CDR".to_owned()),
        };
        Ok(Self { bytes, at: 0, wire, is_big_endian })
    }

    /// Fields without gaps, in little-endian order: those of a ROS 1 message, and of the records of MCAP files and ROS 1 bags.
    pub(crate) fn packed(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, wire: Wire::Ros1, is_big_endian: false }
    }

    /// Bytes that were read.
    pub(crate) fn taken(&self) -> usize {
        self.at
    }

    /// `count` bytes as they are.
    pub(crate) fn raw(&mut self, count: usize) -> Result<&'a [u8], Problem> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| format!("it ends at byte {} of {count} more", self.bytes.len()))?;
        let raw = &self.bytes[self.at..end];
        self.at = end;
        Ok(raw)
    }

    fn number<const SIZE: usize>(&mut self) -> Result<[u8; SIZE], Problem> {
        if self.wire == Wire::Cdr {
            self.at = self.at.next_multiple_of(SIZE);
        }
        let mut bytes = [0; SIZE];
        bytes.copy_from_slice(self.raw(SIZE)?);
        if self.is_big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(crate) fn u8(&mut self) -> Result<u8, Problem> {
        self.number().map(u8::from_le_bytes)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Problem> {
        self.number().map(u16::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Problem> {
        self.number().map(u64::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Problem> {
        self.number().map(u32::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Result<f32, Problem> {
        self.number().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Result<f64, Problem> {
        self.number().map(f64::from_le_bytes)
    }

    /// So many numbers.
    pub(crate) fn f64s<const COUNT: usize>(&mut self) -> Result<[f64; COUNT], Problem> {
        let mut numbers = [0.0; COUNT];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    /// How many follow.
    pub(crate) fn length(&mut self) -> Result<usize, Problem> {
        Ok(self.u32()? as usize)
    }

    /// A list of bytes.
    pub(crate) fn bytes(&mut self) -> Result<&'a [u8], Problem> {
        let count = self.length()?;
        self.raw(count)
    }

    /// Text, whatever its encoding. In CDR a zero ends it.
    pub(crate) fn text(&mut self) -> Result<&'a [u8], Problem> {
        let text = self.bytes()?;
        Ok(match (self.wire, text) {
            (Wire::Cdr, [text @ .., 0]) => text,
            _ => text,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cdr_leaves_gaps_and_ros_1_none() {
        let little = [0, 1, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f];
        // 7, then a text, then at byte 16 a double, counted from behind the first four.
        let mut little = little.to_vec();
        little.splice(14..16, [0, 0, 0, 0, 0, 0]);
        let mut fields = Fields::of(&little, Wire::Cdr).unwrap();
        assert_eq!((fields.u8(), fields.text()), (Ok(7), Ok(&b"a"[..])));
        assert_eq!(fields.f64(), Ok(1.0));
        assert!(fields.u8().unwrap_err().contains("it ends at byte 24"));

        let big = [0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 2, b'a', 0];
        let mut fields = Fields::of(&big, Wire::Cdr).unwrap();
        assert_eq!((fields.u8(), fields.text()), (Ok(7), Ok(&b"a"[..])));

        let ros1 = [7, 1, 0, 0, 0, b'a', 0, 0, 0, 0, 0, 0, 0xf0, 0x3f];
        let mut fields = Fields::of(&ros1, Wire::Ros1).unwrap();
        assert_eq!((fields.u8(), fields.text(), fields.f64()), (Ok(7), Ok(&b"a"[..]), Ok(1.0)));
    }

    #[test]
    fn lengths_beyond_the_message_are_refused() {
        let mut fields = Fields::of(&[0, 1, 0, 0, 255, 255, 255, 255], Wire::Cdr).unwrap();
        assert!(fields.bytes().is_err());
        assert!(Fields::of(b"json", Wire::Cdr).is_err());
        assert!(Fields::of(b"", Wire::Cdr).is_err());
    }
}
