//! Connected pieces among the samples of a surface (docs/CONTEXT.md 1.1.1, steps 4 to 6).

use std::ops::Range;

use super::sample::Sample;

/// Samples are connected when they are at most this many places of the grid apart.
const PIECE_GAP: usize = 2;
/// Bits of a word.
const WORD: usize = u64::BITS as usize;

/// The largest connected piece of samples, `grid` pixels apart. Among pieces of equal size the first one wins, column by column. O(columns · rows of the grid).
pub(super) fn largest_piece<'a>(samples: &[&'a Sample], grid: usize) -> Vec<&'a Sample> {
    let place = |sample: &&Sample| sample.at.map(|x| (x / grid as f64) as usize);
    let places: Vec<[usize; 2]> = samples.iter().map(place).collect();
    find_largest_piece(&places).into_iter().map(|k| samples[k]).collect()
}

/// Finds the largest connected piece among places of a grid (column, row) and returns the indices of its places. Among pieces of
/// equal size the first one wins, column by column. No place occurs twice. O(columns · rows).
fn find_largest_piece(places: &[[usize; 2]]) -> Vec<usize> {
    let [columns, rows] = [0, 1].map(|k| places.iter().map(|place| place[k] + 1).max().unwrap_or(0));
    let mut open = Open::new(columns, rows);
    let mut numbers = vec![0_usize; columns * rows];
    for (k, &[u, v]) in places.iter().enumerate() {
        open.insert(u, v);
        numbers[u * rows + v] = k;
    }
    let mut largest = Vec::new();
    for column in 0..columns {
        let mut word = 0;
        while let Some(row) = open.take_first(column, &mut word) {
            let mut piece = vec![numbers[column * rows + row]];
            let mut around = vec![[column, row]];
            while let Some([u, v]) = around.pop() {
                for u in u.saturating_sub(PIECE_GAP)..columns.min(u + PIECE_GAP + 1) {
                    for v in open.take(u, v.saturating_sub(PIECE_GAP)..v + PIECE_GAP + 1) {
                        piece.push(numbers[u * rows + v]);
                        around.push([u, v]);
                    }
                }
            }
            if piece.len() > largest.len() {
                largest = piece;
            }
        }
    }
    largest
}

/// A set of grid places, one bit each, column by column, so that one word covers 64 rows.
struct Open {
    /// `words_a_column` words of each column. The last one is empty, so that two words can always be read.
    words: Vec<u64>,
    words_a_column: usize,
}

impl Open {
    fn new(columns: usize, rows: usize) -> Self {
        let words_a_column = rows.div_ceil(WORD) + 1;
        Self { words: vec![0; columns * words_a_column], words_a_column }
    }

    fn insert(&mut self, column: usize, row: usize) {
        self.words[column * self.words_a_column + row / WORD] |= 1 << (row % WORD);
    }

    /// Takes out the first place of a column, searching from word `from` on; `from` moves on to the word of this place.
    fn take_first(&mut self, column: usize, from: &mut usize) -> Option<usize> {
        let words = &mut self.words[column * self.words_a_column..][..self.words_a_column];
        *from += words[*from..].iter().position(|&word| word != 0)?;
        let word = &mut words[*from];
        let row = word.trailing_zeros() as usize;
        *word &= *word - 1;
        Some(*from * WORD + row)
    }

    /// Takes out the places in these rows of a column. `rows`: fewer than 64, the first one in the grid.
    fn take(&mut self, column: usize, rows: Range<usize>) -> impl Iterator<Item = usize> + use<> {
        let words = &mut self.words[column * self.words_a_column + rows.start / WORD..][..2];
        let (both, shift) = (u128::from(words[0]) | u128::from(words[1]) << WORD, rows.start % WORD);
        let mut found = both >> shift & ((1 << rows.len()) - 1);
        let left = both & !(found << shift);
        words.copy_from_slice(&[left as u64, (left >> WORD) as u64]);
        std::iter::from_fn(move || {
            let row = (found != 0).then(|| rows.start + found.trailing_zeros() as usize);
            found &= found.wrapping_sub(1);
            row
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Also grids with more rows than a word has bits.
        #[test]
        fn the_largest_piece_is_the_naive_one(
            grid in (1_usize..12, prop_oneof![1_usize..12, 60_usize..140]).prop_flat_map(|(columns, rows)| {
                prop::collection::vec(prop::collection::vec(prop::bool::weighted(0.08), rows), columns)
            }),
            backwards in prop::bool::ANY,
        ) {
            let places_of = |(u, column): (usize, &Vec<bool>)| {
                let taken = column.iter().enumerate().filter(|taken| *taken.1);
                taken.map(|(v, _)| [u, v]).collect::<Vec<_>>()
            };
            let mut places: Vec<[usize; 2]> = grid.iter().enumerate().flat_map(places_of).collect();
            // Connected places take the name of their first place, until nothing changes.
            let mut names: Vec<usize> = (0..places.len()).collect();
            let near = |a: [usize; 2], b: [usize; 2]| (0..2).all(|k| a[k].abs_diff(b[k]) <= 2);
            let mut before = Vec::new();
            while before != names {
                before.clone_from(&names);
                for (a, b) in (0..places.len()).flat_map(|a| (0..a).map(move |b| (a, b))) {
                    if near(places[a], places[b]) {
                        let name = names[a].min(names[b]);
                        (names[a], names[b]) = (name, name);
                    }
                }
            }
            let size = |name: usize| names.iter().filter(|&&n| n == name).count();
            let largest = (0..places.len()).rev().max_by_key(|&name| size(name));
            let members = (0..places.len()).filter(|&k| Some(names[k]) == largest);
            let mut expected: Vec<[usize; 2]> = members.map(|k| places[k]).collect();
            if backwards {
                places.reverse();
            }
            let mut got: Vec<[usize; 2]> = find_largest_piece(&places).into_iter().map(|k| places[k]).collect();
            got.sort_unstable();
            expected.sort_unstable();
            prop_assert_eq!(got, expected);
        }
    }
}
