//! The label of every point of an unorganized cloud, as a PCD file (version 0.7, `DATA binary`).
//!
//! Its points are those of the input, as many and in the same order, with x, y, z as there and `label`: the number of the
//! object, 0 = none. The Point Cloud Library reads it as `PointXYZL`.

use objecthood::Raster;

use crate::capture::Pose;
use crate::organize::PointList;

/// The file of a list of points, of which `labels` are those of the pixels.
pub fn encode(list: &PointList, labels: &Raster<u16>) -> Vec<u8> {
    let points = list.points_m.len();
    let Pose { position_m: [tx, ty, tz], rotation_xyzw: [qx, qy, qz, qw] } =
        list.viewpoint.unwrap_or(Pose::ORIGIN);
    let mut bytes = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\n\
         COUNT 1 1 1 1\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT {tx} {ty} {tz} {qw} {qx} {qy} {qz}\nPOINTS {points}\nDATA binary\n"
    )
    .into_bytes();
    for (point, label) in list.points_m.iter().zip(list.labels(labels)) {
        point.iter().for_each(|part| bytes.extend(part.to_le_bytes()));
        bytes.extend(u32::from(label).to_le_bytes());
    }
    bytes
}
