"""Scenes with a truth, and how well labels agree with it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from objecthood import _native
from objecthood._arrays import _image
from objecthood._native import Capture
from objecthood.errors import InputError


@dataclass(frozen=True)
class Score:
    """How well one label image agrees with the truth, by the definitions of docs/EVALUATION.md."""

    metrics: dict[str, float] | None
    """Overlap and boundary: oP, oR, oF, bP, bR, bF, and p75, each in [0, 1]; None where the truth has no object."""
    objects: list[dict[str, Any]]
    """Every object of the truth: its label, pixels, IoU, and verdict (correct, missed, occlusion, under, over, boundary)."""
    hypotheses: int
    """Hypotheses with a pixel that counts."""
    hypotheses_off_objects: int
    """Hypotheses of which fewer than half of the pixels lie on objects."""

    @property
    def correct(self) -> int:
        """Objects found by the strict count."""
        return sum(thing["verdict"] == "correct" for thing in self.objects)


def score(
    labels: NDArray[np.uint16],
    truth: NDArray[Any],
    *,
    ignore: int | None = None,
    background: int | None = 0,
    mosd: bool = False,
) -> Score:
    """Holds a label image (0 = no object) against a truth of the same size.

    In the truth every value is an object but `background`, and `ignore`, where nothing counts. `mosd`: the truth has the labels of
    mOSD instead, as `Capture.truth` of its files and of `synthetic` has.
    """
    found = _labels("labels", labels, np.uint16)
    true = _labels("truth", truth, np.uint32)
    text = _native.score_mosd(found, true) if mosd else _native.score(found, true, ignore, background)
    return Score(**json.loads(text))


def synthetic(family: str, seed: int, sensor: str = "kinect") -> Capture:
    """A synthetic scene with exact truth, such as `synthetic("tabletop", 7)`. The same seed gives the same scene everywhere.

    Families and sensors are those of `objecthood synth`. `score(.., mosd=True)` reads the `truth` of the capture.
    """
    if seed < 0:
        raise InputError(f"seed is {seed}: give a whole number from 0 on")
    return _native.synthetic(family, seed, sensor)


def _labels(name: str, image: Any, dtype: type[np.unsignedinteger[Any]]) -> NDArray[Any]:
    image = _image(name, image, 2, "HxW")
    if image.dtype.kind not in "ui" or image.min() < 0 or image.max() > np.iinfo(dtype).max:
        raise InputError(f"{name} is {image.dtype}: give whole numbers from 0 to {np.iinfo(dtype).max}")
    return np.ascontiguousarray(image, dtype=dtype)
