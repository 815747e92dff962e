"""From a frame to a discovery."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objecthood import _native
from objecthood._arrays import DepthArray, Gravity, capture_of
from objecthood._native import Capture, Estimates
from objecthood.discovery import Discovery
from objecthood.errors import InputError
from objecthood.params import Params


class Pipeline:
    """Finds the objects of a stream of frames, or of one frame with other parameters.

    It keeps buffers from frame to frame, and the outputs of all stages for the last frame: `set` runs only what follows a changed
    parameter. The result depends on earlier frames only if their `estimates` are given. Several threads may share one, but they wait for each
    other.
    """

    def __init__(
        self,
        params: Params | None = None,
        *,
        method: str | None = None,
        profile: str | None = None,
        threads: int | None = None,
    ) -> None:
        """`method`: context (default) or paper. `profile`: kinect, stereo, tof or phone. `threads`: one a core, unless given."""
        self._params = _params_of(params, method, profile)
        self._native = _native.Pipeline(self._params.to_json(), threads)

    @property
    def params(self) -> Params:
        """A copy of the parameters in force."""
        return Params.from_json(self._native.params)

    def discover(
        self,
        depth: DepthArray | Capture,
        K: ArrayLike | None = None,
        *,
        color: NDArray[np.uint8] | None = None,
        depth_scale: float | None = None,
        gravity: Gravity | None = None,
        estimates: Estimates | None = None,
    ) -> Discovery:
        """As `objecthood.discover`, with the parameters of this pipeline."""
        capture = capture_of(depth, K, color=color, depth_scale=depth_scale, gravity=gravity)
        if estimates is not None and not isinstance(estimates, Estimates):
            raise InputError(f"estimates is {type(estimates).__name__}: give found.estimates of an earlier frame, or None")
        return Discovery(self._native.discover(capture, estimates))

    def set(self, name: str, value: Any) -> Discovery | None:
        """Sets a parameter, as in `set("merging.plane_tolerance_quanta", 1.5)`, and looks at the last frame again.

        Only the first stage that reads the parameter and the stages after it run. None before the first frame.
        """
        params = self.params
        params.set(name, value)
        found = self._native.set(params.to_json())
        return None if found is None else Discovery(found)


def discover(
    depth: DepthArray | Capture,
    K: ArrayLike | None = None,
    *,
    color: NDArray[np.uint8] | None = None,
    depth_scale: float | None = None,
    method: str | None = None,
    params: Params | None = None,
    gravity: Gravity | None = None,
    estimates: Estimates | None = None,
    profile: str | None = None,
    threads: int | None = None,
) -> Discovery:
    """Finds the objects of a frame that can be grasped and moved.

    `depth`: HxW along the optical axis, float32 in metres (NaN or 0 = none), or uint16 with `depth_scale`, the number of units in a
    metre; or a `Capture`, which has everything. `K`: 3x3 or (fx, fy, cx, cy) in pixels. `color`: HxWx3 uint8 RGB, registered to the depth;
    with more pixels if it shows the same field of view.
    `method`: context (default) or paper. `gravity`: the direction in which things fall in the camera frame (x right, y down, z forward), if it
    was measured, or "poses" for a capture with a pose. `estimates`: what earlier frames of the same camera told, `found.estimates` of the
    last one; without it the result depends on this frame alone. `profile`: kind of the sensor. `threads`: one a core, unless given.

    Other Python threads run meanwhile; Ctrl-C ends the call between two stages.
    """
    pipeline = Pipeline(params, method=method, profile=profile, threads=threads)
    return pipeline.discover(depth, K, color=color, depth_scale=depth_scale, gravity=gravity, estimates=estimates)


def _params_of(params: Params | None, method: str | None, profile: str | None) -> Params:
    params = Params() if params is None else Params.from_json(params.to_json())
    if profile is not None:
        params = params.with_profile(profile)
    if method is not None:
        params.method = method
    return params
