//! LZF, the byte compression of Marc Lehmann's liblzf that `binary_compressed` uses.
//!
//! A control byte c begins each piece: c < 32 is followed by c + 1 literal bytes; otherwise its upper three bits plus 2
//! (7: plus the next byte) are the length of a copy from as far back as its lower five bits and one more byte say.

/// Three bytes stand for 264 at most.
const MAX_EXPANSION: usize = 88;

/// Most bytes of a literal piece.
const MAX_LITERAL: usize = 32;

/// Bytes that are copied at a time: most copies are shorter.
const STEP: usize = 16;

/// Where and why data cannot be unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Damage {
    pub(super) at: usize,
    pub(super) problem: &'static str,
}

/// Unpacks `input` to exactly `size` bytes, and allocates nothing if it cannot stand for so many.
pub(super) fn decompress(input: &[u8], size: usize) -> Result<Vec<u8>, Damage> {
    if size > input.len().saturating_mul(MAX_EXPANSION) {
        return Err(Damage { at: input.len(), problem: "too few for what they should unpack to" });
    }
    let mut output = vec![0; size];
    let mut written = 0;
    let mut read = 0;
    while let Some(&control) = input.get(read) {
        let damage = |problem| Damage { at: read, problem };
        let ends = || damage("they end within a piece");
        let overflow = || damage("they unpack to more than they should");

        if control < MAX_LITERAL as u8 {
            let length = usize::from(control) + 1;
            let room = output.get_mut(written..).and_then(<[u8]>::first_chunk_mut::<MAX_LITERAL>);
            if let (Some(room), Some(bytes)) = (room, input.get(read + 1..).and_then(<[u8]>::first_chunk)) {
                // A copy of one size is a few instructions; what it writes too much the next pieces write again.
                *room = *bytes;
            } else {
                let literal = input.get(read + 1..read + 1 + length).ok_or_else(ends)?;
                output.get_mut(written..written + length).ok_or_else(overflow)?.copy_from_slice(literal);
            }
            written += length;
            read += 1 + length;
        } else {
            let long = control >> 5 == 7;
            let extra = if long { usize::from(*input.get(read + 1).ok_or_else(ends)?) } else { 0 };
            let length = usize::from(control >> 5) + 2 + extra;
            let low = read + 1 + usize::from(long);
            let distance =
                (usize::from(control & 31) << 8 | usize::from(*input.get(low).ok_or_else(ends)?)) + 1;
            let start =
                written.checked_sub(distance).ok_or_else(|| damage("a copy from before the beginning"))?;
            if length > size - written {
                return Err(overflow());
            }
            copy_forward(&mut output, start, written, length);
            written += length;
            read = low + 1;
        }
    }
    if written == size {
        Ok(output)
    } else {
        Err(Damage { at: read, problem: "they unpack to less than they should" })
    }
}

/// Copies `length` bytes from `start` to `end`, byte after byte: what was just written is copied again when the two
/// overlap. The stretch from `start` repeats itself, so each step may be longer than all steps before it.
fn copy_forward(bytes: &mut [u8], start: usize, end: usize, length: usize) {
    if end - start >= STEP && end + length + STEP <= bytes.len() {
        // As with literals: behind the piece it may write too much.
        for at in (0..length).step_by(STEP) {
            bytes.copy_within(start + at..start + at + STEP, end + at);
        }
        return;
    }
    let mut copied = 0;
    while copied < length {
        let step = (end - start + copied).min(length - copied);
        bytes.copy_within(start..start + step, end + copied);
        copied += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The format read literally, one byte at a time.
    fn naive(input: &[u8]) -> Option<Vec<u8>> {
        let mut bytes = input.iter().map(|&b| usize::from(b));
        let mut output: Vec<u8> = Vec::new();
        while let Some(control) = bytes.next() {
            if control < 32 {
                for _ in 0..=control {
                    output.push(bytes.next()? as u8);
                }
            } else {
                let mut length = control / 32 + 2;
                if length == 9 {
                    length += bytes.next()?;
                }
                let distance = control % 32 * 256 + bytes.next()? + 1;
                for _ in 0..length {
                    output.push(output[output.len().checked_sub(distance)?]);
                }
            }
        }
        Some(output)
    }

    #[test]
    fn pieces_of_every_kind() {
        assert_eq!(decompress(&[], 0).unwrap(), b"");
        assert_eq!(decompress(&[2, b'a', b'b', b'c'], 3).unwrap(), b"abc");
        assert_eq!(decompress(&[1, b'a', b'b', 0b010_00000, 1], 6).unwrap(), b"ababab");
        let long = decompress(&[0, b'a', 0b111_00000, 255, 0], 265).unwrap();
        assert!(long.iter().all(|&b| b == b'a'));
    }

    #[test]
    fn damage_is_told() {
        for (input, size, problem) in [
            (&[][..], 1, "too few"),
            (&[0, b'a', 0b111_00000], 3, "end within a piece"),
            (&[0, b'a', 0b111_00000, 3], 3, "end within a piece"),
            (&[5, b'a'], 2, "end within a piece"),
            (&[0, b'a', 0b001_00000, 1], 4, "before the beginning"),
            (&[0, b'a', 0b001_00000, 0], 3, "more than they should"),
            (&[1, b'a', b'b'], 1, "more than they should"),
            (&[1, b'a', b'b'], 3, "less than they should"),
        ] {
            let damage = decompress(input, size).unwrap_err();
            assert!(damage.problem.contains(problem), "{input:?}: {damage:?}");
        }
    }

    proptest::proptest! {
        #[test]
        fn agrees_with_the_naive_reading(
            text in "[abc]{8,32}",
            tail in proptest::collection::vec((32_u8..=255, 0_u8..8, 0_u8..20), 0..20),
        ) {
            let mut input = vec![text.len() as u8 - 1];
            input.extend(text.bytes());
            for (control, extra, low) in tail {
                input.push(control & 0b1110_0000);
                if control >> 5 == 7 {
                    input.push(extra);
                }
                input.push(low);
            }
            match naive(&input) {
                Some(output) => proptest::prop_assert_eq!(decompress(&input, output.len()), Ok(output)),
                None => proptest::prop_assert!(decompress(&input, input.len()).is_err()),
            }
        }
    }
}
