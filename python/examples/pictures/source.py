"""Frames of a folder: found at once, read one by one."""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import objecthood

with tempfile.TemporaryDirectory() as folder:
    for seed in range(4):
        scene = objecthood.synthetic("tabletop", seed)
        assert scene.color is not None
        K = np.array([[scene.camera[0], 0, scene.camera[2]], [0, scene.camera[1], scene.camera[3]], [0, 0, 1]])
        np.savez_compressed(Path(folder) / f"scene{seed}.npz", depth=scene.depth, rgb=scene.color, K=K)
    source = objecthood.open(folder)
    pipeline = objecthood.Pipeline()
    figure, axes = plt.subplots(1, len(source), figsize=(14, 2.8), layout="constrained")
    for k, (ax, capture) in enumerate(zip(axes, source)):
        pipeline.discover(capture).plot(ax)
        ax.set_title(f"source.name({k}): {source.name(k)}")
figure.savefig("source.png", dpi=72)
