"""A frame, what was found in it, and what it stands on."""

import matplotlib.pyplot as plt

import objecthood

capture = objecthood.synthetic("stacked", 3)
found = objecthood.discover(capture)

figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
axes[0].imshow(capture.color)
found.plot(axes[1])
axes[2].imshow(found.structure, interpolation="none")
axes[0].set_title("capture.color")
axes[1].set_title("found.plot()")
axes[2].set_title("found.structure")
for edge in found.support[:3]:
    print(f"{edge.lower} carries {edge.upper} ({edge.kind}, {edge.confidence:.2f})")
figure.savefig("discovery.png", dpi=72)
