"""Measures what docs/PYTHON.md says of speed and memory: `python figures.py [FRAMES]`, on a machine that has nothing else to do."""

import statistics
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import objecthood


def median_ms(work: Callable[[], object], times: int = 30) -> float:
    work()
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        taken.append(1e3 * (time.perf_counter() - start))
    return statistics.median(taken)


def resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096 / 1e6


def binding(scene: objecthood.Capture) -> None:
    """All that is not the Rust call: the frame made of arrays, a call that has nothing to find, the labels handed over."""
    depth, color = scene.depth, scene.color
    pipeline = objecthood.Pipeline(threads=1)
    small = np.ones((8, 8), np.float32)
    call = median_ms(lambda: pipeline.discover(small, (8, 8, 4, 4)), 200)
    frame = median_ms(lambda: objecthood._arrays.capture_of(depth, scene.camera, color=color), 200)
    found = pipeline.discover(scene)
    labels = median_ms(found._found.labels, 200)
    print(f"binding: frame {frame:.2f} ms + call {call:.2f} ms + labels {labels:.2f} ms = {frame + call + labels:.2f} ms")
    whole = median_ms(lambda: pipeline.discover(depth, scene.camera, color=color))
    print(f"discover of arrays, one thread: {whole:.1f} ms")


def late_parameter(scene: objecthood.Capture) -> None:
    pipeline = objecthood.Pipeline(threads=1)
    # Of arrays a new frame is made; the same frame would cost nothing the second time.
    depth, color = scene.depth, scene.color
    whole = median_ms(lambda: pipeline.discover(depth, scene.camera, color=color))
    values = iter([0.3, 0.6] * 50)
    late = median_ms(lambda: pipeline.set("objectness.threshold", next(values)))
    print(f"Pipeline.set of objectness.threshold: {late:.2f} ms, {late / whole:.2f} of a frame")


def threads(scene: objecthood.Capture, each: int = 40) -> None:
    depth, color = scene.depth, scene.color

    def work() -> None:
        pipeline = objecthood.Pipeline(threads=1)
        for _ in range(each):
            pipeline.discover(depth, scene.camera, color=color)

    def rate(count: int) -> float:
        group = [threading.Thread(target=work) for _ in range(count)]
        start = time.perf_counter()
        for one in group:
            one.start()
        for one in group:
            one.join()
        return count * each / (time.perf_counter() - start)

    work()
    print(f"two threads: {rate(2) / rate(1):.2f} times the frames of one")


def memory(scene: objecthood.Capture, frames: int) -> None:
    depth, color = scene.depth, scene.color
    early = 0.0
    for k in range(frames):
        objecthood.discover(depth, scene.camera, color=color, threads=1)
        if k == frames // 10:
            early = resident_mb()
    print(f"{frames} frames through discover: {early:.1f} MB resident after a tenth, {resident_mb():.1f} MB at the end")


if __name__ == "__main__":
    made = objecthood.synthetic("tabletop", 7)
    binding(made)
    late_parameter(made)
    threads(made)
    memory(made, int(sys.argv[1]) if len(sys.argv) > 1 else 5000)
