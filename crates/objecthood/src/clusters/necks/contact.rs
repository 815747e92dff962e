//! Which parts lie beside each other, and where they touch (docs/CONTEXT.md 4.7).

use crate::clusters::cluster::Clusters;
use crate::neighbours::four_neighbours;
use crate::regions::SegmentId;

/// Parts lie beside each other along at least this many pairs of pixels (px at 525 px), ...
const BESIDE_PX: usize = 8;
/// ... and a smaller part has too few colours to compare (px at 525 px).
const PART_PX: usize = 100;

/// Whether a cluster is large enough to be compared.
pub(super) fn is_part(clusters: &Clusters<'_>, id: SegmentId) -> bool {
    clusters.get(id).pixels.len() >= clusters.scene.space.area_px(PART_PX)
}

/// The clusters that lie beside a cluster, touching or not, and are large enough to be compared.
pub(super) fn beside<'a>(clusters: &'a Clusters<'_>, id: SegmentId) -> impl Iterator<Item = SegmentId> + 'a {
    let neighbours = clusters.get(id).neighbours.iter();
    let near = neighbours.filter(|(_, borders)| is_long(clusters, borders.all()));
    near.filter_map(|(other, _)| *other).filter(|&other| is_part(clusters, other))
}

/// Whether two parts touch, and not only at a corner.
pub(super) fn touch(clusters: &Clusters<'_>, [a, b]: [SegmentId; 2]) -> bool {
    is_long(clusters, clusters.borders(a, b).touch)
}

fn is_long(clusters: &Clusters<'_>, pairs: u32) -> bool {
    pairs as usize >= clusters.scene.space.length_px(BESIDE_PX)
}

/// The pairs of neighbouring pixels, the first in one part and the second in the other, in the order of the
/// first. O(pixels of the part).
pub(super) fn pixel_pairs<'a>(
    clusters: &'a Clusters<'_>,
    [of, with]: [SegmentId; 2],
) -> impl Iterator<Item = (usize, usize)> + 'a {
    let (width, height) = clusters.scene.disparity.size();
    let own = clusters.get(of).pixels.iter().map(|&i| i as usize);
    let pairs = own.flat_map(move |i| four_neighbours(i, width, height).map(move |(j, _)| (i, j)));
    pairs.filter(move |&(_, j)| clusters.at_pixel(j) == Some(with))
}

/// The pixels of one part that touch the other. O(pixels of the part).
pub(super) fn contacts(clusters: &Clusters<'_>, parts: [SegmentId; 2]) -> Vec<usize> {
    let scene = clusters.scene;
    let touching = pixel_pairs(clusters, parts).filter(|&(i, j)| scene.steps.touch(scene.disparity, i, j));
    let mut pixels: Vec<usize> = touching.map(|(i, _)| i).collect();
    pixels.dedup();
    pixels
}
