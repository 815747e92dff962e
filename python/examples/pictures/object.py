"""One object: its pixels, and its points with its box seen from above."""

import matplotlib.pyplot as plt
import numpy as np

import objecthood

capture = objecthood.synthetic("stacked", 3)
assert capture.color is not None
thing = objecthood.discover(capture)[0]
left, top, right, bottom = (int(edge) for edge in thing.xyxy)
box = thing.box3d
points = (thing.points() - box.center) @ box.rotation  # along the axes of the box

figure, (image, plan) = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
image.imshow(np.where(thing.mask()[..., None], capture.color, 255)[top:bottom, left:right])
image.set_title(f"object {thing.id}, objectness {thing.objectness:.2f}")
plan.plot(points[:, 0], points[:, 2], ".", markersize=1)
width, _, length = box.size
plan.add_patch(plt.Rectangle((-width / 2, -length / 2), width, length, fill=False))
plan.set(title="thing.points() in thing.box3d", xlabel="m", ylabel="m", aspect="equal")
figure.savefig("object.png", dpi=72)
