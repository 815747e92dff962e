"""Reads what `objecthood convert` wrote with NumPy and the MCAP libraries, and compares it with the images."""

import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from PIL import Image

folder = Path(sys.argv[1])
names = ["000000", "000001"]
depth = [(np.array(Image.open(folder / f"in/{n}-depth.png")) / 10000).astype(np.float32) for n in names]
depth = [np.where(z == 0, np.nan, z) for z in depth]
color = [np.array(Image.open(folder / f"in/{n}-color.png")) for n in names]

for name, z, rgb in zip(names, depth, color):
    data = np.load(folder / f"npz/{name}.npz")
    assert np.array_equal(data["depth"], z, equal_nan=True) and (data["rgb"] == rgb).all()
    assert data["K"].tolist() == [[262.5, 0, 159.5], [0, 262.5, 119.5], [0, 0, 1]]

with open(folder / "frames.mcap", "rb") as file:
    messages = [(c.topic, m.log_time, ros) for _, c, m, ros in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages()]
of = lambda topic: [(time, ros) for t, time, ros in messages if t == topic]
images = of("/camera/aligned_depth_to_color/image_raw")
assert [time for time, _ in images] == [0, 10**9 // 30]
for (_, image), z in zip(images, depth):
    assert image.encoding == "32FC1" and np.array_equal(np.frombuffer(image.data, "<f4").reshape(z.shape), z, equal_nan=True)
for (_, image), rgb in zip(of("/camera/color/image_raw"), color):
    assert image.encoding == "rgb8" and (np.frombuffer(image.data, np.uint8).reshape(rgb.shape) == rgb).all()
for topic in ("/camera/color/camera_info", "/camera/aligned_depth_to_color/camera_info"):
    assert [list(info.k) for _, info in of(topic)] == [[262.5, 0, 159.5, 0, 262.5, 119.5, 0, 0, 1]] * 2
