//! RVL, the lossless compression of depth in `compressed_depth_image_transport`.
//!
//! Pixels are runs of zeros and runs of others in turn; of the others each is the difference to the one before. Numbers are
//! groups of three bits, the lowest first, each with a bit that says whether more follow; eight such nibbles are a
//! little-endian word, the first on top.
//!
//! Source: Wilson, *Fast Lossless Depth Image Compression*, ISS 2017.

/// Nibbles of a word.
const NIBBLES: usize = 8;

/// The pixels of an image of `pixels` pixels; `None` when the words end before, or a run leaves the image.
///
/// O(pixels). The caller has bounded `pixels`.
pub(super) fn decode(words: &[u8], pixels: usize) -> Option<Vec<u16>> {
    let mut numbers = Numbers { words, nibbles_taken: 0 };
    let mut depth = Vec::with_capacity(pixels);
    let mut last = 0_u16;
    while depth.len() < pixels {
        let (zeros, others) = (numbers.next()? as usize, numbers.next()? as usize);
        if zeros > pixels - depth.len() || others > pixels - depth.len() - zeros || zeros + others == 0 {
            return None;
        }
        depth.resize(depth.len() + zeros, 0);
        for _ in 0..others {
            let coded = numbers.next()?;
            let change = (coded >> 1) as i32 ^ -((coded & 1) as i32);
            last = last.wrapping_add(change as u16);
            depth.push(last);
        }
    }
    Some(depth)
}

struct Numbers<'a> {
    words: &'a [u8],
    nibbles_taken: usize,
}

impl Numbers<'_> {
    fn next(&mut self) -> Option<u32> {
        let mut number = 0;
        for place in 0..NIBBLES + 2 {
            let nibble = self.nibble()?;
            number |= u32::from(nibble & 7).checked_shl(3 * place as u32)?;
            if nibble & 8 == 0 {
                return Some(number);
            }
        }
        None
    }

    fn nibble(&mut self) -> Option<u8> {
        let (word, place) = (self.nibbles_taken / NIBBLES, self.nibbles_taken % NIBBLES);
        self.nibbles_taken += 1;
        // The first nibble of a word is the upper half of its last byte.
        let byte = *self.words.get(4 * word + 3 - place / 2)?;
        Some(if place % 2 == 0 { byte >> 4 } else { byte & 15 })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The encoder as the paper prints it.
    fn encode(depth: &[u16]) -> Vec<u8> {
        fn put(words: &mut Vec<u32>, state: &mut (u32, usize), mut value: u32) {
            loop {
                let mut nibble = value & 7;
                value >>= 3;
                if value != 0 {
                    nibble |= 8;
                }
                state.0 = (state.0 << 4) | nibble;
                state.1 += 1;
                if state.1 == 8 {
                    words.push(state.0);
                    *state = (0, 0);
                }
                if value == 0 {
                    return;
                }
            }
        }
        let (mut words, mut state, mut last, mut rest) = (Vec::new(), (0, 0), 0_i32, depth);
        while !rest.is_empty() {
            let zeros = rest.iter().take_while(|&&z| z == 0).count();
            let others = rest[zeros..].iter().take_while(|&&z| z != 0).count();
            put(&mut words, &mut state, zeros as u32);
            put(&mut words, &mut state, others as u32);
            for &z in &rest[zeros..zeros + others] {
                let change = i32::from(z) - last;
                put(&mut words, &mut state, ((change << 1) ^ (change >> 31)) as u32);
                last = i32::from(z);
            }
            rest = &rest[zeros + others..];
        }
        if state.1 > 0 {
            words.push(state.0 << (4 * (8 - state.1)));
        }
        words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    proptest! {
        #[test]
        fn what_the_papers_encoder_wrote_is_read(
            depth in prop::collection::vec(prop_oneof![3 => Just(0_u16), 5 => 990..1010_u16, 1 => any::<u16>()], 1..300),
        ) {
            prop_assert_eq!(decode(&encode(&depth), depth.len()), Some(depth));
        }

        #[test]
        fn any_bytes_are_an_image_or_none(words in prop::collection::vec(any::<u8>(), 0..200), pixels in 1..500_usize) {
            prop_assert!(decode(&words, pixels).is_none_or(|depth| depth.len() == pixels));
        }
    }

    #[test]
    fn runs_that_leave_the_image_are_refused() {
        let words = encode(&[0, 0, 0, 5, 6]);
        assert_eq!(decode(&words, 4), None);
        assert_eq!(decode(&words[..4], 5).is_some(), words.len() == 4);
        assert_eq!(decode(&[], 1), None);
        assert_eq!(decode(&[0; 400], 9), None, "runs of nothing");
    }
}
