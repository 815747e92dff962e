//! Convex hulls of regions in the image.

/// Part of an image row, from a first to a last column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowSpan {
    pub(crate) v: usize,
    pub(crate) first: usize,
    pub(crate) last: usize,
}

/// The convex hull of a region in the image.
pub(crate) struct Hull {
    rows: Vec<RowSpan>,
    width: usize,
}

impl Hull {
    /// The hull of pixels in scan order. O(pixels + rows).
    pub(crate) fn of(pixels: &[u32], width: usize) -> Self {
        let spans = find_row_spans(pixels.iter().map(|&i| i as usize), width);
        Self { rows: fill_hull(&spans), width }
    }

    /// Whether a pixel lies in the hull. O(1).
    pub(crate) fn contains(&self, i: usize) -> bool {
        let (u, v) = (i % self.width, i / self.width);
        let row = self.rows.first().and_then(|top| self.rows.get(v.checked_sub(top.v)?));
        row.is_some_and(|row| (row.first..=row.last).contains(&u))
    }
}

/// The span of the pixels in each row. `pixels`: in scan order. O(pixels).
pub(crate) fn find_row_spans(pixels: impl Iterator<Item = usize>, width: usize) -> Vec<RowSpan> {
    let mut spans: Vec<RowSpan> = Vec::new();
    let mut row = 0..0;
    for i in pixels {
        // Most pixels lie in the row of the previous one, so a division is rare.
        if let Some(span) = spans.last_mut().filter(|_| row.contains(&i)) {
            span.last = i - row.start;
            continue;
        }
        let (v, u) = (i / width, i % width);
        row = v * width..(v + 1) * width;
        spans.push(RowSpan { v, first: u, last: u });
    }
    spans
}

/// The pixels whose centres lie in the convex hull of the spans' ends. `spans`: by ascending row.
pub(crate) fn fill_hull(spans: &[RowSpan]) -> Vec<RowSpan> {
    let left = chain(spans.iter().map(|span| [span.first as i64, span.v as i64]), 1);
    let right = chain(spans.iter().map(|span| [span.last as i64, span.v as i64]), -1);
    let (Some(&[_, top]), Some(&[_, bottom])) = (left.first(), left.last()) else { return Vec::new() };
    let (mut l, mut r) = (0, 0);
    (top..=bottom)
        .map(|v| {
            // Rounded inwards.
            let first = -crossing(&left, &mut l, v, -1);
            let last = crossing(&right, &mut r, v, 1);
            RowSpan { v: v as usize, first: first as usize, last: last as usize }
        })
        .collect()
}

/// The corners of one side of a hull, from top to bottom. `side`: 1 = left, -1 = right.
fn chain(points: impl Iterator<Item = [i64; 2]>, side: i64) -> Vec<[i64; 2]> {
    let mut corners: Vec<[i64; 2]> = Vec::new();
    for [u, v] in points {
        while let [.., [a, b], [c, d]] = corners[..] {
            let turn = (c - a) * (v - b) - (d - b) * (u - a);
            if side * turn < 0 {
                break;
            }
            corners.pop();
        }
        corners.push([u, v]);
    }
    corners
}

/// The column in which a side of the hull crosses row `v`, times `sign`, rounded down. `at`: the corner above, which only moves down.
fn crossing(corners: &[[i64; 2]], at: &mut usize, v: i64, sign: i64) -> i64 {
    while corners.get(*at + 1).is_some_and(|corner| corner[1] <= v) {
        *at += 1;
    }
    let [a, b] = corners[*at];
    let Some([c, d]) = corners.get(*at + 1) else { return sign * a };
    (sign * (a * (d - v) + c * (v - b))).div_euclid(d - b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_contains_what_lies_between_its_pixels() {
        // A ring of 10 x 10 pixels whose corner is missing.
        let width = 20;
        let is_ring = |u: usize, v: usize| {
            let is_in = (4..14).contains(&u) && (5..15).contains(&v);
            is_in && !((6..12).contains(&u) && (7..13).contains(&v)) && u + v > 11
        };
        let ring: Vec<u32> = (0..400).filter(|i| is_ring(i % width, i / width)).map(|i| i as u32).collect();
        let hull = Hull::of(&ring, width);
        for i in 0..400 {
            let (u, v) = (i % width, i / width);
            let expected = (4..14).contains(&u) && (5..15).contains(&v) && u + v > 11;
            assert_eq!(hull.contains(i), expected, "{u} {v}");
        }
        assert!(!Hull::of(&[], width).contains(0));
    }
}
