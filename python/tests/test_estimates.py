"""What frames tell is handed on to the next frame, if it is asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import objecthood as oh

K = (262.5, 262.5, 159.5, 119.5)


def told(found: oh.Discovery) -> oh.Estimates:
    assert found.estimates is not None
    return found.estimates


def sparse() -> np.ndarray[Any, np.dtype[np.float32]]:
    """One pixel in sixteen of a wall: no block of pixels is measured, and there is no ground."""
    depth = np.full((240, 320), np.nan, np.float32)
    depth[::4, ::4] = 1.1
    return depth


def test_a_stream_counts_its_frames_and_the_noise_is_their_mean(scene: oh.Capture, found: oh.Discovery) -> None:
    pipeline = oh.Pipeline(threads=1)
    noisier = oh.synthetic("tabletop", 7, "stereo")
    alone = told(oh.discover(noisier))
    first = told(pipeline.discover(scene))
    second = told(pipeline.discover(noisier, estimates=first))
    third = told(oh.discover(scene, estimates=second))
    assert first == told(found) != second
    assert [first.frames, second.frames, third.frames] == [1, 2, 3]
    assert np.isclose(second.waves, np.sqrt(first.waves * alone.waves)), "the mean of the logarithms"
    assert first.waves < third.waves < second.waves < alone.waves
    assert np.allclose(first.blocks_quanta[1], 0.21 * first.waves), "a Kinect has 0.21"
    assert first.up is not None and np.allclose(first.up, found.up)
    assert repr(second).startswith("<objecthood.Estimates of 2 frames: white noise ") and "Kinect's, up (" in repr(second)
    with pytest.raises(AttributeError):
        setattr(first, "frames", 7)


def test_a_frame_without_a_ground_has_the_noise_and_the_up_of_those_before_it(found: oh.Discovery) -> None:
    alone = oh.discover(sparse(), K)
    assert alone.scene["up"]["source"] == "camera" and told(alone).up is None
    assert repr(told(alone)).startswith("<objecthood.Estimates of 0 frames:") and repr(told(alone)).endswith("up unknown>")
    earlier = told(found)
    after = oh.discover(sparse(), K, estimates=earlier)
    assert after.scene["up"]["source"] == "earlier" and after.up.tolist() == list(earlier.up or ())
    assert told(after) == earlier, "it is handed on"


def test_without_estimates_a_result_depends_on_its_frame_alone(scene: oh.Capture, found: oh.Discovery) -> None:
    noisier = told(oh.discover(oh.synthetic("tabletop", 7, "stereo")))
    pipeline = oh.Pipeline()
    handed_on = pipeline.discover(scene, estimates=noisier)
    assert handed_on.scene["noise"] != found.scene["noise"]
    assert not np.array_equal(handed_on.stages["facets"], found.stages["facets"]), "its stages are looked at with them too"
    # Neither the pipeline nor the capture keeps them.
    for capture in (scene, handed_on.capture):
        for again in (pipeline.discover(capture), pipeline.discover(capture, estimates=None), oh.discover(capture)):
            assert again.to_json() == found.to_json() and np.array_equal(again.labels, found.labels)


def test_set_looks_at_the_last_frame_with_its_estimates(scene: oh.Capture) -> None:
    noisier = told(oh.discover(oh.synthetic("tabletop", 7, "stereo")))
    pipeline = oh.Pipeline()
    pipeline.discover(scene, estimates=noisier)
    again = pipeline.set("objectness.threshold", 0.6)
    assert again is not None
    fresh = oh.discover(scene, params=pipeline.params, estimates=noisier)
    assert again.to_json() == fresh.to_json() and told(again) == told(fresh) and told(again).frames == 2


def test_paper_tells_nothing_and_asks_for_nothing(scene: oh.Capture, found: oh.Discovery) -> None:
    paper = oh.discover(scene, method="paper")
    assert paper.estimates is None
    assert oh.discover(scene, method="paper", estimates=found.estimates).to_json() == paper.to_json()


@pytest.mark.parametrize("wrong", [3, "up", {"frames": 1}, (0.0, -1.0, 0.0)], ids=repr)
def test_what_is_no_estimates_is_refused(scene: oh.Capture, wrong: Any) -> None:
    said = f"estimates is {type(wrong).__name__}: give found.estimates of an earlier frame, or None"
    for discover in (oh.discover, oh.Pipeline().discover):
        with pytest.raises(oh.InputError) as refused:
            discover(scene, estimates=wrong)
        assert str(refused.value) == said


def test_a_discovery_is_no_estimates(found: oh.Discovery) -> None:
    wrong: Any = found
    with pytest.raises(oh.InputError, match="estimates is Discovery: give found.estimates"):
        oh.discover(found.capture, estimates=wrong)
