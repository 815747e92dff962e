//! LZF, the byte compression of PCD files, as `objecthood_io::formats::pcd` unpacks it.

const HASH_BITS: u32 = 15;
const MAX_DISTANCE: usize = 1 << 13;
const MAX_COPY: usize = 264;
const MAX_LITERAL: usize = 32;

/// Packs `input`: greedily, every three bytes that were seen within the last 8192 become a copy.
pub(super) fn compress(input: &[u8]) -> Vec<u8> {
    let mut output = Vec::with_capacity(input.len() / 2);
    // Place behind the last occurrence of three bytes with this hash; 0 = never.
    let mut seen = vec![0_usize; 1 << HASH_BITS];
    let (mut at, mut literal) = (0, 0);
    while let Some(&[a, b, c]) = input.get(at..).and_then(<[u8]>::first_chunk) {
        let key = u32::from(a) << 16 | u32::from(b) << 8 | u32::from(c);
        let slot = (key.wrapping_mul(0x9e37_79b1) >> (32 - HASH_BITS)) as usize;
        let before = std::mem::replace(&mut seen[slot], at + 1);
        let start = before.wrapping_sub(1);
        if before > 0 && at - start <= MAX_DISTANCE && input[start..start + 3] == [a, b, c] {
            let length =
                input[at..].iter().zip(&input[start..]).take(MAX_COPY).take_while(|(x, y)| x == y).count();
            write_literals(&mut output, &input[literal..at]);
            write_copy(&mut output, length, at - start);
            at += length;
            literal = at;
        } else {
            at += 1;
        }
    }
    write_literals(&mut output, &input[literal..]);
    output
}

fn write_literals(output: &mut Vec<u8>, bytes: &[u8]) {
    for piece in bytes.chunks(MAX_LITERAL) {
        output.push(piece.len() as u8 - 1);
        output.extend_from_slice(piece);
    }
}

fn write_copy(output: &mut Vec<u8>, length: usize, distance: usize) {
    let back = distance - 1;
    let high = (back >> 8) as u8;
    if length < 9 {
        output.push((length as u8 - 2) << 5 | high);
    } else {
        output.push(7 << 5 | high);
        output.push((length - 9) as u8);
    }
    output.push((back & 0xff) as u8);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Rng;

    /// The format read literally.
    fn unpack(input: &[u8]) -> Vec<u8> {
        let mut bytes = input.iter().map(|&b| usize::from(b));
        let mut output: Vec<u8> = Vec::new();
        while let Some(control) = bytes.next() {
            if control < 32 {
                output.extend(bytes.by_ref().take(control + 1).map(|b| b as u8));
            } else {
                let mut length = control / 32 + 2;
                if length == 9 {
                    length += bytes.next().unwrap();
                }
                let distance = control % 32 * 256 + bytes.next().unwrap() + 1;
                (0..length).for_each(|_| output.push(output[output.len() - distance]));
            }
        }
        output
    }

    #[test]
    fn everything_comes_back() {
        let mut rng = Rng::new(4, 0);
        for alphabet in [1, 2, 3, 20, 256] {
            for length in [0, 1, 2, 3, 31, 32, 33, 263, 264, 265, 266, 9000, 60_000] {
                let input: Vec<u8> = (0..length).map(|_| rng.below(alphabet) as u8).collect();
                let packed = compress(&input);
                assert_eq!(unpack(&packed), input, "{alphabet} {length}");
                assert!(alphabet > 1 || length < 9000 || packed.len() < length / 2);
            }
        }
    }
}
