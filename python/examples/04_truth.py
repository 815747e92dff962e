"""Scenes whose truth is known: how good is a method on a kind of scene?"""

import objecthood

pipeline = objecthood.Pipeline(method="context")
for seed in range(3):
    scene = objecthood.synthetic("tabletop", seed)
    assert scene.truth is not None
    figures = objecthood.score(pipeline.discover(scene).labels, scene.truth, mosd=True)
    print(f"scene {seed}: {figures.correct} of {len(figures.objects)} objects found, {figures.hypotheses_off_objects} hypotheses elsewhere")
