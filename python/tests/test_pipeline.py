"""Streams, threads, signals and memory."""

from __future__ import annotations

import _thread
import os
import signal
import subprocess
import sys
import threading
import time
from itertools import pairwise

import numpy as np
import pytest

import objecthood as oh


def test_a_pipeline_gives_what_single_calls_give(scene: oh.Capture, found: oh.Discovery) -> None:
    other = oh.synthetic("single", 3)
    pipeline = oh.Pipeline(threads=1)
    for capture in (scene, other, scene):
        assert np.array_equal(pipeline.discover(capture).labels, oh.discover(capture).labels)
    assert np.array_equal(pipeline.discover(scene).labels, found.labels)


def test_set_is_a_fresh_run_with_the_value(scene: oh.Capture) -> None:
    pipeline = oh.Pipeline()
    assert pipeline.set("objectness.threshold", 0.5) is None, "no frame yet"
    pipeline.discover(scene)
    for name, value in (("merging.plane_tolerance_quanta", 1.5), ("objectness.threshold", 0.9), ("method", "paper")):
        again = pipeline.set(name, value)
        assert again is not None
        assert np.array_equal(again.labels, oh.discover(scene, params=pipeline.params).labels), name
    for name in ("objectness.treshold", "threshold", "objectness", "merging", "method.x", ""):
        with pytest.raises(oh.ParameterError, match="no parameter"):
            pipeline.set(name, 1)
    with pytest.raises(oh.ParameterError, match="outside its range"):
        pipeline.set("objectness.threshold", 2)
    with pytest.raises(oh.ParameterError):
        pipeline.set("objectness.threshold", "much")
    assert pipeline.params.objectness.threshold == 0.9, "a refused value leaves the old one"


def test_threads_may_share_a_pipeline_and_run_their_own(scene: oh.Capture, found: oh.Discovery) -> None:
    shared = oh.Pipeline(threads=1)
    wrong: list[str] = []

    def look(own: bool) -> None:
        for _ in range(5):
            labels = (oh.discover(scene, threads=1) if own else shared.discover(scene)).labels
            if not np.array_equal(labels, found.labels):
                wrong.append("own" if own else "shared")

    threads = [threading.Thread(target=look, args=(k % 2 == 0,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def longest_pause(capture: oh.Capture) -> float:
    """The longest time for which no other thread runs while one looks, as a share of the call."""
    call: list[float] = []

    def look() -> None:
        call.append(time.perf_counter())
        oh.discover(capture, method="paper")
        call.append(time.perf_counter())

    worker = threading.Thread(target=look)
    ran: list[float] = []
    worker.start()
    while worker.is_alive():
        ran.append(time.perf_counter())
    began, ended = call
    times = [began, *(at for at in ran if began < at < ended), ended]
    return max(later - at for at, later in pairwise(times)) / (ended - began)


def test_the_interpreter_is_released(scene: oh.Capture) -> None:
    """A call that held the interpreter would stop other threads for nearly all of it, each time; load stops them for a part."""
    capture = oh.discover(scene).capture
    assert min(longest_pause(capture) for _ in range(5)) < 0.5


def test_ctrl_c_ends_a_long_call() -> None:
    depth = np.full((3000, 4000), 1.2, np.float32)
    depth += np.random.default_rng(1).normal(0, 0.003, depth.shape).astype(np.float32)
    pipeline = oh.Pipeline(method="paper")
    main, caller = threading.get_ident(), oh.Pipeline.discover.__code__
    ended = threading.Event()
    asked: list[float] = []

    def press() -> None:
        """Presses the key once the call runs, however long that takes to begin."""
        while not ended.wait(0.1):
            frame = sys._current_frames()[main]
            if frame.f_code is caller:
                asked.append(time.monotonic())
                _thread.interrupt_main()
                return

    finger = threading.Thread(target=press)
    finger.start()
    with pytest.raises(KeyboardInterrupt):
        try:
            pipeline.discover(depth, (3000, 3000, 2000, 1500))
        finally:
            ended.set()
    finger.join()
    assert asked, "the call was over before the key was pressed"
    # The pipeline can be used again.
    assert len(pipeline.discover(depth[:480, :640], (525, 525, 319.5, 239.5)).labels) == 480


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_fork_can_use_the_pipeline_of_its_parent(scene: oh.Capture, found: oh.Discovery) -> None:
    """A fork has none of its parent's threads: with those of the parent it would wait for ever."""
    pipeline = oh.Pipeline()
    pipeline.discover(scene)
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        same = False
        try:
            same = np.array_equal(pipeline.discover(scene).labels, found.labels)
        finally:
            # Also after an exception: the child must not go on with the tests of its parent.
            os._exit(0 if same else 1)
    assert os.waitpid(child, 0)[1] == 0


def test_memory_does_not_grow(scene: oh.Capture) -> None:
    """In a process of its own, because tests before this one leave their memory behind.

    With one heap: glibc gives a thread a heap when it finds the others locked, so a new one (30 MB here) can appear at any frame.
    What leaks stays in any heap.
    """
    code = """
import objecthood as oh
def kilobytes():
    return int(next(line for line in open('/proc/self/status') if line.startswith('VmRSS')).split()[1])
capture = oh.synthetic('single', 3)
depth, camera, color = capture.depth, capture.camera, capture.color
for k in range(60):
    found = oh.discover(depth, camera, color=color)
    found.labels, found.boxes3d, found.parents, found[0].points()
    if k == 20:
        before = kilobytes()
print(kilobytes() - before)
"""
    if not os.path.exists("/proc/self/status"):
        pytest.skip("skipped: this system does not tell how much memory a process has")
    one_heap = {**os.environ, "MALLOC_ARENA_MAX": "1"}
    grown = int(subprocess.run([sys.executable, "-c", code], env=one_heap, capture_output=True, text=True, check=True).stdout)
    # Less than a tenth of the pixels of 40 frames, 2 MB each.
    assert grown < 8_000, f"{grown} kB in 40 frames"
