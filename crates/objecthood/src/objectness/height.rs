//! What hardly rises above the support is a part of it (METHOD 3.11).

use crate::objectness::clusters::Clusters;
use crate::params;

/// Gives clusters whose top is lower than `min_top_m` above the support surface to the background: remains of the table and
/// crumbs at the edge of what is seen. Without a support surface nothing is done.
pub(crate) fn drop_low(clusters: &mut Clusters<'_>, params: &params::Height) {
    let Some(support) = clusters.scene.support else { return };
    for id in clusters.alive() {
        if clusters.top_m(id, support) < params.min_top_m {
            clusters.merge(None, id);
        }
    }
}
