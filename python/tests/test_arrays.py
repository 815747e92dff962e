"""Every array is answered: with a result, or with an exception that says what to do. None crashes the interpreter."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import objecthood as oh

K = (52.5, 52.5, 31.5, 23.5)


def wall(dtype: Any = np.float32) -> np.ndarray[Any, Any]:
    return np.full((48, 64), 1.2, dtype=dtype)


@pytest.mark.parametrize(
    ("depth", "said"),
    [
        (wall(np.float64), "float64"),
        (wall(">f8"), "float64"),
        (wall(np.float16), "float16"),
        (wall(np.complex64), "complex64"),
        (wall(np.int32), "int32"),
        (wall(bool), "bool"),
        (wall(object), "object"),
        (np.zeros((4, 4), dtype=[("z", "f4")]), "plain numbers"),
        (np.array([["a"]]), "U1"),
        (np.zeros((2, 2), dtype="datetime64[s]"), "datetime64"),
        (wall()[0], "HxW"),
        (wall()[None], "HxW"),
        (np.float32(1.0), "give a NumPy array"),
        (np.zeros((), np.float32), "HxW"),
        (np.zeros((0, 64), np.float32), "at least one pixel"),
        (np.zeros((48, 0), np.float32), "at least one pixel"),
        ([[1.0, 2.0]], "list"),
        (None, "NoneType"),
        ("depth.png", "str"),
        (np.ma.masked_array(wall(), mask=False), "masked"),
        (np.full((48, 64), np.nan, np.float32), "no pixel has a valid depth"),
        (np.zeros((48, 64), np.float32), "no pixel has a valid depth"),
        (np.full((48, 64), -np.inf, np.float32), "no pixel has a valid depth"),
        (np.lib.stride_tricks.as_strided(np.ones(1, np.float32), (1 << 15, 1 << 14), (0, 0)), "2^28"),
        (np.lib.stride_tricks.as_strided(np.ones(1, np.float32), (1 << 40, 1 << 20), (0, 0)), "2^28"),
    ],
)
def test_depth_that_is_none_is_refused(depth: Any, said: str) -> None:
    with pytest.raises(oh.InputError) as refused:
        oh.discover(depth, K)
    assert said in str(refused.value)
    assert "--" not in str(refused.value), "no option of the command line"


@pytest.mark.parametrize(
    ("color", "said"),
    [
        (np.zeros((48, 64), np.uint8), "HxWx3"),
        (np.zeros((48, 64, 4), np.uint8), "RGB"),
        (np.zeros((48, 64, 0), np.uint8), "at least one pixel"),
        (np.zeros((48, 64, 3), np.float32), "uint8"),
        (np.zeros((48, 60, 3), np.uint8), "registered"),
        ("color.png", "NumPy array"),
    ],
)
def test_colour_that_is_none_is_refused(color: Any, said: str) -> None:
    with pytest.raises(oh.InputError, match=said):
        oh.discover(wall(), K, color=color)


@pytest.mark.parametrize(
    "camera",
    ["x", (1, 2, 3), np.eye(4), (0, 52, 31, 23), (np.nan, 52, 31, 23), (1e300, 52, 31, 23), [[1, 2], [3]], np.ones((3, 3)), object()],
)
def test_a_camera_that_is_none_is_refused(camera: Any) -> None:
    with pytest.raises(oh.InputError):
        oh.discover(wall(), camera)


def test_the_other_arguments_are_checked() -> None:
    with pytest.raises(TypeError, match="K is missing"):
        oh.discover(wall())
    with pytest.raises(oh.InputError, match="depth_scale is missing"):
        oh.discover(wall(np.uint16), K)
    for scale in (0, -1, float("nan"), float("inf")):
        with pytest.raises(oh.InputError, match="depth_scale"):
            oh.discover(wall(), K, depth_scale=scale)
    wrong: list[Any] = [(0, 0, 0), (np.nan, 1, 0), (1, 2), "up", object(), "poses"]
    for gravity in wrong:
        with pytest.raises(oh.InputError):
            oh.discover(wall(), K, gravity=gravity)
    with pytest.raises(oh.ParameterError, match="threads"):
        oh.discover(wall(), K, threads=0)
    with pytest.raises(oh.ParameterError, match="method|variant"):
        oh.discover(wall(), K, method="magic")
    with pytest.raises(oh.ParameterError, match="kinect, stereo"):
        oh.discover(wall(), K, profile="lidar")
    with pytest.raises(TypeError, match="leave out"):
        oh.discover(oh.synthetic("single", 1), K)


def test_the_layout_of_an_array_changes_nothing(scene: oh.Capture, found: oh.Discovery) -> None:
    depth, color, camera = scene.depth, scene.color, scene.camera
    assert color is not None
    unaligned = np.frombuffer(b"x" + depth.tobytes(), np.float32, offset=1).reshape(depth.shape)
    frozen = depth.copy()
    frozen.flags.writeable = False
    wide = np.zeros((*depth.shape, 2), np.float32)
    wide[..., 1] = depth
    layouts = [
        (depth, color),
        (np.asfortranarray(depth), np.asfortranarray(color)),
        (depth[::-1].copy()[::-1], color[:, ::-1].copy()[:, ::-1]),
        (unaligned, color),
        (frozen, color[..., ::-1].copy()[..., ::-1]),
        (wide[..., 1], color),
        (depth.astype(">f4"), color),
        (np.where(np.isnan(depth), 0, depth).astype(np.float32), color),
    ]
    for depths, colors in layouts:
        again = oh.discover(depths, camera, color=colors)
        assert np.array_equal(again.labels, found.labels), depths.flags


def test_units_are_those_that_are_said(scene: oh.Capture, found: oh.Discovery) -> None:
    millimetres = np.nan_to_num(np.round(scene.depth * 1000)).astype(np.uint16)
    metres = (millimetres / 1000).astype(np.float32)
    by_unit = oh.discover(millimetres, scene.camera, color=scene.color, depth_scale=1000)
    assert np.array_equal(by_unit.labels, oh.discover(metres, scene.camera, color=scene.color).labels)
    as_floats = oh.discover(millimetres.astype(np.float32), scene.camera, color=scene.color, depth_scale=1000)
    assert np.array_equal(by_unit.labels, as_floats.labels)
    # The greatest value is no depth.
    far = np.full((48, 64), 65535, np.uint16)
    with pytest.raises(oh.InputError, match="no pixel"):
        oh.discover(far, K, depth_scale=1000)


def test_a_matrix_and_its_four_numbers_are_one_camera(scene: oh.Capture, found: oh.Discovery) -> None:
    fx, fy, cx, cy = scene.camera
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    assert np.array_equal(oh.discover(scene.depth, matrix, color=scene.color).labels, found.labels)


def test_the_frame_is_not_the_callers_array(scene: oh.Capture, found: oh.Discovery) -> None:
    depth = scene.depth
    before = depth.copy()
    pipeline = oh.Pipeline()
    pipeline.discover(depth, scene.camera, color=scene.color)
    assert np.array_equal(depth, before, equal_nan=True), "the array is as it was"
    depth[:] = 1.0
    again = pipeline.set("objectness.threshold", 0.55)
    assert again is not None and np.array_equal(again.labels, found.labels)
