"""Parameters from a file, and both methods with theirs."""

import matplotlib.pyplot as plt

import objecthood

capture = objecthood.synthetic("tabletop", 7)
context = objecthood.Params.from_toml("[objectness]\nthreshold = 0.4\n")
paper = objecthood.Params()
paper.method = "paper"

figure, axes = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
for ax, params in zip(axes, (context, paper)):
    objecthood.discover(capture, params=params).plot(ax)
    ax.set_title(f'params.method = "{params.method}"')
figure.savefig("params.png", dpi=72)
