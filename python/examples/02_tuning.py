"""One frame with other parameters: only the stages that a change reaches run again."""

import time

import objecthood

pipeline = objecthood.Pipeline()
pipeline.discover(objecthood.synthetic("tabletop", 7))
for threshold in (0.2, 0.5, 0.8):
    start = time.perf_counter()
    found = pipeline.set("objectness.threshold", threshold)
    assert found is not None
    print(f"threshold {threshold}: {len(found)} objects, after {1e3 * (time.perf_counter() - start):.1f} ms")
print(pipeline.params.to_toml().splitlines()[0], "..")
