"""The same frame with other parameters: only the stages behind the change run again."""

import matplotlib.pyplot as plt

import objecthood

pipeline = objecthood.Pipeline()
pipeline.discover(objecthood.synthetic("clutter", 1))

figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
for ax, threshold in zip(axes, (0.2, 0.5, 0.8)):
    found = pipeline.set("objectness.threshold", threshold)
    assert found is not None
    found.plot(ax)
    ax.set_title(f'set("objectness.threshold", {threshold}): {len(found)} objects')
figure.savefig("pipeline.png", dpi=72)
