"""Writes one scene as recordings of every kind, with programs that know nothing of objecthood.

Arguments: the folder to write to. It holds depth.npy (uint16, millimetres) and color.npy (uint8, RGB).
"""
import io, struct, sys
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, Writer as McapWriter
from PIL import Image as Picture
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

out = Path(sys.argv[1])
depth, color = np.load(out / "depth.npy"), np.load(out / "color.npy")
height, width = depth.shape
ROS1, ROS2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
K = [80.0, 0.0, 39.5, 0.0, 80.0, 29.5, 0.0, 0.0, 1.0]
FRAMES = 5


def stamp(k):
    return 1_700_000_000_000_000_000 + k * 50_000_000


def png(array):
    stream = io.BytesIO()
    Picture.fromarray(array).save(stream, "PNG")
    return np.frombuffer(stream.getvalue(), np.uint8)


class Maker:
    """Messages of one version of ROS."""

    def __init__(self, store, is_ros1=False):
        self.store, self.t, self.is_ros1 = store, store.types, is_ros1

    def header(self, k, frame):
        ns = stamp(k)
        time = self.t["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
        rest = {"seq": k} if self.is_ros1 else {}
        return self.t["std_msgs/msg/Header"](stamp=time, frame_id=frame, **rest)

    def image(self, k, frame, array, encoding, big=0, pad=0):
        rows = array.reshape(array.shape[0], -1)
        rows = (rows.byteswap() if big else rows).view(np.uint8)
        rows = np.concatenate([rows, np.full((len(rows), pad), 7, np.uint8)], axis=1)
        return self.t["sensor_msgs/msg/Image"](
            header=self.header(k, frame), height=array.shape[0], width=array.shape[1], encoding=encoding,
            is_bigendian=big, step=rows.shape[1], data=rows.reshape(-1))

    def compressed(self, k, frame, data, form):
        return self.t["sensor_msgs/msg/CompressedImage"](header=self.header(k, frame), format=form, data=data)

    def info(self, k, frame, d=(0.0,) * 5, size=None):
        names = {"D": np.array(d), "K": np.array(K), "R": np.eye(3).reshape(-1), "P": np.zeros(12)}
        names = names if self.is_ros1 else {name.lower(): value for name, value in names.items()}
        roi = self.t["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        h, w = size or (height, width)
        return self.t["sensor_msgs/msg/CameraInfo"](
            header=self.header(k, frame), height=h, width=w, distortion_model="plumb_bob",
            binning_x=0, binning_y=0, roi=roi, **names)

    def points(self, k, frame, pad):
        z = np.where(depth == 0, np.nan, depth / 1000.0).astype(np.float32)
        v, u = np.mgrid[0:height, 0:width]
        xyz = np.stack([(u - K[2]) / K[0] * z, (v - K[5]) / K[4] * z, z], axis=-1).astype(np.float32)
        r, g, b = (color[..., i].astype(np.uint32) for i in range(3))
        rows = np.zeros((height, width, 5), np.float32)
        rows[..., :3], rows[..., 4] = xyz, (r << 16 | g << 8 | b).view(np.float32)
        rows = np.concatenate([rows.view(np.uint8).reshape(height, -1), np.zeros((height, pad), np.uint8)], axis=1)
        field = lambda name, at: self.t["sensor_msgs/msg/PointField"](name=name, offset=at, datatype=7, count=1)
        return self.t["sensor_msgs/msg/PointCloud2"](
            header=self.header(k, frame), height=height, width=width,
            fields=[field("x", 0), field("y", 4), field("z", 8), field("rgb", 16)], is_bigendian=False,
            point_step=20, row_step=rows.shape[1], data=rows.reshape(-1), is_dense=False)

    def tf(self, *edges):
        t = self.t
        return t["tf2_msgs/msg/TFMessage"](transforms=[
            t["geometry_msgs/msg/TransformStamped"](
                header=self.header(0, parent), child_frame_id=child, transform=t["geometry_msgs/msg/Transform"](
                    translation=t["geometry_msgs/msg/Vector3"](*map(float, shift)),
                    rotation=t["geometry_msgs/msg/Quaternion"](*map(float, turn))))
            for parent, child, shift, turn in edges])

    def write(self, kind, message):
        return self.store.serialize_ros1(message, kind) if self.is_ros1 else self.store.serialize_cdr(message, kind)


def raw(maker):
    """Depth and colour as they were measured, a camera, and a topic that is no image."""
    for k in range(FRAMES):
        yield "/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "optical")
        yield "/camera/color/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "optical", color[..., ::-1].copy(), "bgr8", pad=3)
        yield "/camera/depth/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "optical", depth, "16UC1", big=k % 2)
        yield "/imu", "geometry_msgs/msg/Vector3", k, maker.t["geometry_msgs/msg/Vector3"](1.0, 2.0, 3.0)


def rvl_words(image):
    """RVL after Wilson, "Fast Lossless Depth Image Compression" (2017): a bit that says whether more follow and three bits a nibble."""
    flat, nibbles, last, at = [int(z) for z in image.reshape(-1)], [], 0, 0

    def put(number):
        while True:
            number, low = number >> 3, number & 7
            nibbles.append(low | (8 if number else 0))
            if not number:
                return

    def run(is_none):
        end = at
        while end < len(flat) and (flat[end] == 0) == is_none:
            end += 1
        return end - at

    while at < len(flat):
        none = run(True)
        at += none
        some = run(False)
        put(none), put(some)
        for z in flat[at:at + some]:
            change, last = z - last, z
            put(2 * change if change >= 0 else -2 * change - 1)
        at += some
    nibbles += [0] * (-len(nibbles) % 8)
    words = (sum(nibble << 28 - 4 * k for k, nibble in enumerate(nibbles[i:i + 8])) for i in range(0, len(nibbles), 8))
    return b"".join(struct.pack("<I", word) for word in words)


def rvl(maker):
    return compressed(maker, "rvl", struct.pack("<ii", width, height) + rvl_words(depth))


def compressed(maker, form="png", data=png(depth).tobytes()):
    packed = np.frombuffer(struct.pack("<iff", 0, 0.0, 0.0) + data, np.uint8)
    for k in range(FRAMES):
        yield "/c/depth/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "optical")
        yield "/c/rgb/compressed", "sensor_msgs/msg/CompressedImage", k, maker.compressed(k, "optical", png(color), "rgb8; png compressed bgr8")
        yield "/c/depth/compressedDepth", "sensor_msgs/msg/CompressedImage", k, maker.compressed(k, "optical", packed, f"16UC1; compressedDepth {form}")


def points(maker):
    for k in range(FRAMES):
        yield "/points", "sensor_msgs/msg/PointCloud2", k, maker.points(k, "optical", 8)


def floats(maker):
    z = np.where(depth == 0, np.nan, depth.astype(np.float64) / 1000.0).astype(np.float32)
    for k in range(FRAMES):
        yield "/d/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "optical")
        yield "/d/image", "sensor_msgs/msg/Image", k, maker.image(k, "optical", z, "32FC1")
        yield "/rgb/image", "sensor_msgs/msg/Image", k, maker.image(k, "optical", color, "rgb8")


def apart(maker):
    """The colour camera is 0.1 m to the right of the depth camera and has twice the pixels; both hang from base_link."""
    big = color.repeat(2, 0).repeat(2, 1)
    info = maker.info(0, "color_optical", size=big.shape[:2])
    info.k[[0, 4]], info.k[[2, 5]] = 160.0, (79.5, 59.5)
    yield "/tf_static", "tf2_msgs/msg/TFMessage", 0, maker.tf(
        ("base_link", "depth_optical", (0, 0, 1), (-0.5, 0.5, -0.5, 0.5)),
        ("depth_optical", "color_optical", (0.1, 0, 0), (0, 0, 0, 1)))
    for k in range(FRAMES):
        yield "/depth/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "depth_optical")
        yield "/depth/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "depth_optical", depth, "16UC1")
        yield "/color/camera_info", "sensor_msgs/msg/CameraInfo", k, info
        yield "/color/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "color_optical", big, "rgb8")


def far(maker):
    """As `apart`, but nobody says where the cameras are."""
    return (message for message in apart(maker) if message[0] != "/tf_static")


def bent(maker):
    for k in range(FRAMES):
        yield "/depth/camera_info", "sensor_msgs/msg/CameraInfo", k, maker.info(k, "optical", d=(-0.2, 0.05, 0.01, 0.0, 0.0))
        yield "/depth/image_raw", "sensor_msgs/msg/Image", k, maker.image(k, "optical", depth, "16UC1")


def rosbag2(name, messages, plugin):
    maker = Maker(ROS2)
    with Writer(out / name, version=8, storage_plugin=plugin) as writer:
        connections = {}
        for topic, kind, k, message in messages(maker):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS2)
            writer.write(connections[topic], stamp(k) + len(connections), maker.write(kind, message))


def rosbag1(name, messages, compression=None):
    maker = Maker(ROS1, is_ros1=True)
    bag = BagWriter(out / name)
    if compression:
        bag.set_compression(getattr(bag.CompressionFormat, compression))
    with bag as writer:
        connections = {}
        for topic, kind, k, message in messages(maker):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=ROS1)
            writer.write(connections[topic], stamp(k), maker.write(kind, message))


def mcap(name, messages, **options):
    maker = Maker(ROS2)
    with open(out / name, "wb") as stream:
        writer = McapWriter(stream, **options)
        writer.start("ros2")
        channels = {}
        for topic, kind, k, message in messages(maker):
            if topic not in channels:
                schema = writer.register_schema(kind, "ros2msg", b"")
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channels[topic], stamp(k), maker.write(kind, message), stamp(k))
        writer.finish()


for plugin, name in ((StoragePlugin.MCAP, "mcap"), (StoragePlugin.SQLITE3, "db3")):
    for messages in (raw, compressed, points):
        rosbag2(f"{messages.__name__}_{name}", messages, plugin)
for name, options in {
    "plain": {"compression": CompressionType.NONE},
    "lz4": {"compression": CompressionType.LZ4, "chunk_size": 20_000},
    "zstd": {"compression": CompressionType.ZSTD, "chunk_size": 60_000},
    "unchunked": {"use_chunking": False},
}.items():
    mcap(f"{name}.mcap", raw, **options)
for messages in (rvl, floats, apart, far, bent):
    mcap(f"{messages.__name__}.mcap", messages)
for name, compression in (("plain", None), ("bz2", "BZ2"), ("lz4", "LZ4")):
    rosbag1(f"{name}.bag", raw, compression)
rosbag1("compressed.bag", compressed)
