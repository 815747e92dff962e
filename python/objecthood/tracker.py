"""Objects through video."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objecthood import _native
from objecthood._arrays import DepthArray, Gravity, capture_of
from objecthood._native import Capture
from objecthood.errors import InputError
from objecthood.params import Params


class Tracker:
    """Follows objects through a video: the only class that remembers earlier frames."""

    def __init__(self, params: Params | None = None, *, threads: int | None = None) -> None:
        self._native = _native.Tracker((params or Params()).to_json(), threads)

    def update(
        self,
        depth: DepthArray | Capture,
        K: ArrayLike | None = None,
        *,
        stamp: float | None = None,
        color: NDArray[np.uint8] | None = None,
        depth_scale: float | None = None,
        gravity: Gravity | None = None,
        pose: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Tracked:
        """Takes the next frame. `stamp` (s) has to rise; a capture may have its own. `pose`: position (m) and quaternion x, y, z, w that
        take the camera's points to the world, if that is known. Ctrl-C is heard when the frame is done."""
        capture = capture_of(depth, K, color=color, depth_scale=depth_scale, gravity=gravity)
        if stamp is None:
            if capture.stamp_ns is None:
                raise InputError("the frame has no stamp: say when it was taken, stamp=.. in seconds")
            stamp = capture.stamp_ns * 1e-9
        return Tracked(self._native.update(capture, stamp, None if pose is None else _pose(*pose)))

    def finish(self) -> list[dict[str, Any]]:
        """Events that become certain when the video ends."""
        events: list[dict[str, Any]] = json.loads(self._native.finish())
        return events

    def skip(self) -> None:
        """Passes over a frame that could not be read or shows nothing: it is counted, and nothing is known of it."""
        self._native.skip()

    def reset(self) -> None:
        """Forgets everything. Numbers begin at 1 again."""
        self._native.reset()


class Tracked:
    """What the tracker says of a frame."""

    def __init__(self, native: _native.Tracked) -> None:
        self._native = native

    @cached_property
    def labels(self) -> NDArray[np.uint16]:
        """HxW: the track at every pixel, 0 = none. The numbers last."""
        return self._native.labels()

    @cached_property
    def data(self) -> dict[str, Any]:
        """Everything else: frame, stamp_s, objects, lost, agents, support, events, world_from_camera and notices."""
        data: dict[str, Any] = json.loads(self._native.data())
        return data

    @property
    def objects(self) -> list[dict[str, Any]]:
        """The objects: track (None while it is tentative), state, center_m, pose, parts, velocity_m_per_s, motion, xyxy, box_m,
        objectness."""
        objects: list[dict[str, Any]] = self.data["objects"]
        return objects

    @property
    def events(self) -> list[dict[str, Any]]:
        """What became certain with this frame."""
        events: list[dict[str, Any]] = self.data["events"]
        return events


def _pose(position: ArrayLike, quaternion: ArrayLike) -> tuple[list[float], list[float]]:
    try:
        place, turn = (np.asarray(part, dtype=np.float64).ravel().tolist() for part in (position, quaternion))
    except (TypeError, ValueError):
        place, turn = [], []
    if (len(place), len(turn)) != (3, 4):
        raise InputError("the pose is none: give a position (3 numbers) and a quaternion x, y, z, w (4 numbers)")
    return place, turn
