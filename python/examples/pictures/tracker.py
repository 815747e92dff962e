"""Numbers that last, in a window that slides over an image."""

import matplotlib.pyplot as plt
import numpy as np

import objecthood

scene = objecthood.synthetic("tabletop", 7)
depth, color = scene.depth, scene.color
assert color is not None
fx, fy, cx, cy = scene.camera
tracker = objecthood.Tracker()

figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
for k, ax in enumerate(axes):
    # The principal point slides with the window.
    window = np.s_[:, 40 * k : 40 * k + 560]
    for repeat in range(4):
        tracked = tracker.update(depth[window], (fx, fy, cx - 40 * k, cy), color=color[window], stamp=(4 * k + repeat) / 30)
    ax.imshow(color[window])
    shown = np.ma.masked_equal(tracked.labels, 0)
    ax.imshow(shown, cmap="tab10", vmin=1, vmax=10, alpha=0.6, interpolation="none")
    for thing in tracked.objects:
        left, top, _, _ = thing["xyxy"]
        ax.text(left, top, f"track {thing['track']}")
    ax.set_axis_off()
    ax.set_title(f"frame {4 * k + 3}")
figure.savefig("tracker.png", dpi=72)
