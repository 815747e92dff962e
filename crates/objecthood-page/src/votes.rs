//! How borders vote, as a map.

use objecthood::facets::Facets;
use objecthood::params::Contraction;
use objecthood::shapes::border::BorderEvidence;
use objecthood::{RegionGraph, SegmentId};

use crate::maps::map;
use crate::pack::{Kind, Map};

/// A vote of this share of the border's length is the greatest that is told apart.
const FULL: f64 = 127.0;

/// The vote of the border on which a pixel lies, as a share of its length: 127 = all for one shape, -127 = all for two, 0 = no border
/// that was measured. Pixels on both sides have it. O(pixels log borders).
pub(crate) fn votes(facets: &Facets, evidence: &RegionGraph<BorderEvidence>, params: &Contraction) -> Map {
    let labels = facets.segments.labels();
    let shares = evidence.map(|edge| {
        let length_m = edge.evidence.gaps.length_m.max(f64::MIN_POSITIVE);
        let share = (edge.evidence.vote_m(params) / length_m).clamp(-1.0, 1.0);
        // No vote is not no border.
        let sign = if share < 0.0 { -1.0 } else { 1.0 };
        (share * FULL).abs().round().max(1.0) * sign
    });
    let mut votes = vec![0_i8; labels.len()];
    let mut mark = |i: usize, j: usize| {
        let (Some(a), Some(b)) = (facets.segments.at(i), facets.segments.at(j)) else { return };
        if a != b
            && let Some(vote) = between(&shares, a, b)
        {
            (votes[i], votes[j]) = (vote as i8, vote as i8);
        }
    };
    let (width, height) = labels.size();
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            if u + 1 < width {
                mark(i, i + 1);
            }
            if v + 1 < height {
                mark(i, i + width);
            }
        }
    }
    map("votes", Kind::I8, labels.size(), votes.into_iter().map(|vote| vote as u8).collect())
}

fn between(votes: &RegionGraph<f64>, a: SegmentId, b: SegmentId) -> Option<f64> {
    let pair = (a.min(b), a.max(b));
    let edges = votes.edges();
    let found = edges.binary_search_by(|edge| (edge.a, edge.b).cmp(&pair)).ok()?;
    Some(edges[found].evidence)
}
