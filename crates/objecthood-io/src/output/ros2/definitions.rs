//! The definitions of message types, as an MCAP file holds them: the fields of the type, then those of the types that it is made of.
//!
//! Source: the interface packages of ROS 2 (`common_interfaces`, `geometry2`) and Foxglove's `foxglove_msgs`.

/// A type and its fields.
const TYPES: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    (
        "sensor_msgs/Image",
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
    ),
    (
        "sensor_msgs/RegionOfInterest",
        "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n",
    ),
    (
        "sensor_msgs/CameraInfo",
        "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n\
         float64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
    ),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    ("foxglove_msgs/Color", "float64 r\nfloat64 g\nfloat64 b\nfloat64 a\n"),
    ("foxglove_msgs/KeyValuePair", "string key\nstring value\n"),
    (
        "foxglove_msgs/ArrowPrimitive",
        "geometry_msgs/Pose pose\nfloat64 shaft_length\nfloat64 shaft_diameter\nfloat64 head_length\nfloat64 head_diameter\nfoxglove_msgs/Color color\n",
    ),
    (
        "foxglove_msgs/CubePrimitive",
        "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\nfoxglove_msgs/Color color\n",
    ),
    (
        "foxglove_msgs/SpherePrimitive",
        "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\nfoxglove_msgs/Color color\n",
    ),
    (
        "foxglove_msgs/CylinderPrimitive",
        "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\nfloat64 bottom_scale\nfloat64 top_scale\nfoxglove_msgs/Color color\n",
    ),
    (
        "foxglove_msgs/LinePrimitive",
        "uint8 type\ngeometry_msgs/Pose pose\nfloat64 thickness\nbool scale_invariant\ngeometry_msgs/Point[] points\n\
         foxglove_msgs/Color color\nfoxglove_msgs/Color[] colors\nuint32[] indices\n",
    ),
    (
        "foxglove_msgs/TriangleListPrimitive",
        "geometry_msgs/Pose pose\ngeometry_msgs/Point[] points\nfoxglove_msgs/Color color\nfoxglove_msgs/Color[] colors\nuint32[] indices\n",
    ),
    (
        "foxglove_msgs/TextPrimitive",
        "geometry_msgs/Pose pose\nbool billboard\nfloat64 font_size\nbool scale_invariant\nfoxglove_msgs/Color color\nstring text\n",
    ),
    (
        "foxglove_msgs/ModelPrimitive",
        "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nfoxglove_msgs/Color color\nbool override_color\nstring url\n\
         string media_type\nuint8[] data\n",
    ),
    ("foxglove_msgs/SceneEntityDeletion", "builtin_interfaces/Time timestamp\nuint8 type\nstring id\n"),
    (
        "foxglove_msgs/SceneEntity",
        "builtin_interfaces/Time timestamp\nstring frame_id\nstring id\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\n\
         foxglove_msgs/KeyValuePair[] metadata\nfoxglove_msgs/ArrowPrimitive[] arrows\nfoxglove_msgs/CubePrimitive[] cubes\n\
         foxglove_msgs/SpherePrimitive[] spheres\nfoxglove_msgs/CylinderPrimitive[] cylinders\nfoxglove_msgs/LinePrimitive[] lines\n\
         foxglove_msgs/TriangleListPrimitive[] triangles\nfoxglove_msgs/TextPrimitive[] texts\nfoxglove_msgs/ModelPrimitive[] models\n",
    ),
    (
        "foxglove_msgs/SceneUpdate",
        "foxglove_msgs/SceneEntityDeletion[] deletions\nfoxglove_msgs/SceneEntity[] entities\n",
    ),
];

/// The fields of a type. Every type that is written stands on the list.
fn fields(name: &str) -> &'static str {
    TYPES.iter().find(|(of, _)| *of == name).map_or("", |(_, fields)| fields)
}

/// The definition of a type called as in a file, `package/msg/Type`, with all types that it is made of.
pub(in crate::output) fn definition(name: &str) -> String {
    let name = name.replace("/msg/", "/");
    let mut text = fields(&name).to_owned();
    let mut parts: Vec<&str> = Vec::new();
    let mut open = fields(&name).lines().rev().collect::<Vec<_>>();
    while let Some(line) = open.pop() {
        let kind = line.split([' ', '[']).next().unwrap_or_default();
        if kind.contains('/') && !parts.contains(&kind) {
            parts.push(kind);
            text += &format!(
                "================================================================================\nMSG: {kind}\n{}",
                fields(kind)
            );
            open.extend(fields(kind).lines().rev());
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_holds_each_type_that_it_needs_once() {
        for (name, _) in TYPES {
            let text = definition(name);
            for line in text.lines().filter(|line| !line.starts_with("MSG: ")) {
                let kind = line.split([' ', '[']).next().unwrap();
                if kind.contains('/') {
                    assert_eq!(text.matches(&format!("MSG: {kind}\n")).count(), 1, "{name}: {kind}");
                    assert!(!fields(kind).is_empty(), "{kind}");
                }
            }
        }
        assert_eq!(definition("builtin_interfaces/msg/Time"), "int32 sec\nuint32 nanosec\n");
    }
}
