"""Labels against a truth, object by object."""

import matplotlib.pyplot as plt

import objecthood

scene = objecthood.synthetic("vessels", 2)
assert scene.truth is not None
found = objecthood.discover(scene)
score = objecthood.score(found.labels, scene.truth, mosd=True)

figure, (truth, labels) = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
truth.imshow(scene.truth, cmap="tab20", interpolation="none")
truth.set_title(f"truth: {len(score.objects)} objects")
truth.set_axis_off()
found.plot(labels)
labels.set_title(f"{score.correct} correct, {score.hypotheses_off_objects} elsewhere")
figure.savefig("score.png", dpi=72)
