"""What a capture has: colour, depth, and the truth of a scene that has one."""

import matplotlib.pyplot as plt

import objecthood

capture = objecthood.synthetic("vessels", 2, sensor="stereo")
print(capture, capture.camera)

figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
axes[0].imshow(capture.color)
axes[1].imshow(capture.depth, cmap="viridis")
axes[2].imshow(capture.truth, cmap="tab20", interpolation="none")
for ax, name in zip(axes, ("capture.color", "capture.depth (m)", "capture.truth")):
    ax.set_axis_off()
    ax.set_title(name)
figure.savefig("capture.png", dpi=72)
