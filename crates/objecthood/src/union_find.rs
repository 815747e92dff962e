//! Disjoint sets over the indices 0..n.

use crate::buffers::Buffer;

/// A forest of parents. The caller decides which root survives a union, because numbers and statistics belong to the root.
pub(crate) struct UnionFind {
    parent: Buffer<u32>,
}

impl UnionFind {
    /// `n` sets of one member each.
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect::<Vec<_>>().into() }
    }

    /// One set for each pixel of an image, in reused memory.
    pub(crate) fn of_pixels(pixels: usize) -> Self {
        Self { parent: (0..pixels as u32).collect() }
    }

    /// The root of the set of `i`; shortens the path on the way (path halving). Amortised O(log n).
    #[inline]
    pub(crate) fn find(&mut self, mut i: usize) -> usize {
        loop {
            let parent = self.parent[i];
            if parent as usize == i {
                return i;
            }
            let grandparent = self.parent[parent as usize];
            self.parent[i] = grandparent;
            i = grandparent as usize;
        }
    }

    /// Makes the grandparent of `i` its parent, and returns it. Has no branch: the grandparent of a root is the root itself.
    #[inline]
    pub(crate) fn two_up(&mut self, i: usize) -> usize {
        let grandparent = self.parent[self.parent[i] as usize];
        self.parent[i] = grandparent;
        grandparent as usize
    }

    /// Joins the set with root `child` to the set with root `root`.
    #[inline]
    pub(crate) fn link(&mut self, root: usize, child: usize) {
        self.parent[child] = root as u32;
    }

    /// Numbers the sets from 0 in ascending order of their roots. Returns the number of each member's set, and the number of sets.
    pub(crate) fn groups(mut self) -> (Vec<u32>, usize) {
        let n = self.parent.len();
        let mut number = vec![0; n];
        let mut count = 0;
        for root in (0..n).filter(|&i| self.parent[i] as usize == i) {
            number[root] = count;
            count += 1;
        }
        ((0..n).map(|i| number[self.find(i)]).collect(), count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_numbered_by_their_roots() {
        let mut sets = UnionFind::new(6);
        sets.link(4, 1);
        sets.link(2, 5);
        sets.link(4, 2);
        assert_eq!(sets.find(5), 4);
        assert_eq!(sets.groups(), (vec![0, 2, 2, 1, 2, 2], 3));
    }
}
