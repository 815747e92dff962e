"""Writes a video in the layout of TUM as recordings, one good and some with a mistake, with programs that know nothing of objecthood.

Arguments: the video, and the folder to write to.
"""
import json, sys
from pathlib import Path

import numpy as np
from PIL import Image as Picture
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

video, out = map(Path, sys.argv[1:])
STORE = get_typestore(Stores.ROS2_HUMBLE)
KINDS = STORE.types
FRAMES, STEP_NS = 24, 66_666_667
camera = json.loads((video / "camera.json").read_text())


def files(what):
    lines = (line.split() for line in (video / f"{what}.txt").read_text().splitlines() if not line.startswith("#"))
    return [np.array(Picture.open(video / name)) for _, name in list(lines)[:FRAMES]]


depths = [np.round(raw / camera["depth_scale"] * 1000).astype(np.uint16) for raw in files("depth")]
colors = [color[..., :3] for color in files("rgb")]


def header(ns):
    return KINDS["std_msgs/msg/Header"](KINDS["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9), "optical")


def image(ns, array, encoding):
    rows = np.ascontiguousarray(array).view(np.uint8).reshape(len(array), -1)
    return KINDS["sensor_msgs/msg/Image"](header(ns), *array.shape[:2], encoding, 0, rows.shape[1], rows.reshape(-1))


def info(ns):
    k = np.array([camera["fx"], 0, camera["cx"], 0, camera["fy"], camera["cy"], 0, 0, 1.0])
    roi = KINDS["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    return KINDS["sensor_msgs/msg/CameraInfo"](
        header(ns), *depths[0].shape, "plumb_bob", np.zeros(5), k, np.eye(3).reshape(-1), np.zeros(12), 0, 0, roi)


def write(name, order=range(FRAMES), measured=lambda k: k, depth=lambda depth: depth):
    """The frames of `order`; frame k has the stamp of `measured(k)`, and `depth` changes what the sensor said."""
    with Writer(out / name, version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        kinds = {"depth/image_raw": "Image", "color/image_raw": "Image", "color/camera_info": "CameraInfo"}
        topics = {t: writer.add_connection(f"/{t}", f"sensor_msgs/msg/{kinds[t]}", typestore=STORE) for t in kinds}
        for k in order:
            ns = 10**18 + measured(k) * STEP_NS
            messages = (image(ns, depth(depths[k]), "16UC1"), image(ns, colors[k], "rgb8"), info(ns))
            for (topic, kind), message in zip(kinds.items(), messages):
                data = STORE.serialize_cdr(message, f"sensor_msgs/msg/{kind}")
                writer.write(topics[topic], 10**18 + k * STEP_NS, data)


write("good")
write("dropped", order=[k for k in range(FRAMES) if k not in (8, 9, 10)])
write("set_back", measured=lambda k: k % (FRAMES // 2))
write("frozen", depth=lambda _: depths[0])
write("shifted", depth=lambda depth: np.roll(depth, 8, axis=1))
write("ten_times", depth=lambda depth: np.minimum(depth.astype(int) * 10, 65535).astype(np.uint16))
write("one_byte", depth=lambda depth: depth // 256 * 256)
