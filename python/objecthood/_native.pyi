"""The native half. What is not exported by `objecthood` itself is no public API."""

from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Capture",
    "Estimates",
    "Found",
    "Pipeline",
    "Source",
    "Tracked",
    "Tracker",
    "__version__",
    "extensions",
    "parameter_table",
    "params_from_toml",
    "params_to_toml",
    "params_with_profile",
    "read_camera",
    "read_images",
    "score",
    "score_mosd",
    "synthetic",
    "write_together",
]

__version__: str

@final
class Capture:
    """One RGB-D image with its camera. It never changes."""

    @staticmethod
    def of_floats(
        depth: NDArray[np.float32],
        camera: tuple[float, float, float, float],
        color: NDArray[np.uint8] | None,
        depth_scale: float | None,
    ) -> Capture: ...
    @staticmethod
    def of_integers(
        depth: NDArray[np.uint16],
        camera: tuple[float, float, float, float],
        color: NDArray[np.uint8] | None,
        depth_scale: float,
    ) -> Capture: ...
    def with_gravity(self, gravity: tuple[float, float, float]) -> Capture:
        """The same frame with the direction in which things fall, in the frame of the file's points."""

    def with_gravity_of_pose(self) -> Capture:
        """The same frame with gravity along -z of the world of its pose."""

    @property
    def name(self) -> str:
        """Name of the frame: of files the name without its ending; empty for arrays."""

    @property
    def path(self) -> str:
        """The file it is from; empty for arrays."""

    @property
    def stamp_ns(self) -> int | None:
        """When the depth was measured (ns by the clock of the source), if that is known."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""

    @property
    def camera(self) -> tuple[float, float, float, float]:
        """Focal lengths and principal point: fx, fy, cx, cy (px)."""

    @property
    def depth(self) -> NDArray[np.float32]:
        """Depth along the optical axis, HxW (m), NaN = none. A copy."""

    @property
    def color(self) -> NDArray[np.uint8] | None:
        """Colour, HxWx3 RGB, if there is any. A copy."""

    @property
    def truth(self) -> NDArray[np.uint32] | None:
        """The true label of every pixel, HxW as the file has it, if there is a truth. A copy."""

    @property
    def pose(self) -> tuple[list[float], list[float]] | None:
        """Where the camera was, if that is known: position (m) and unit quaternion x, y, z, w that take its points to the world."""

@final
class Estimates:
    """What frames tell of their sensor and of up, for the next frame of the same camera. It never changes.

    A Kinect v1 is 1 in `white_noise` and `waves`. `discover(.., estimates=found.estimates)` hands them on.
    """

    @property
    def white_noise(self) -> float:
        """Standard deviation of single pixels, relative to a Kinect v1."""

    @property
    def waves(self) -> float:
        """Noise of 16 to 40 px in length, relative to a Kinect v1."""

    @property
    def blocks_quanta(self) -> tuple[float, float, float]:
        """Disagreement of neighbouring blocks of 8, 16 and 32 px at a focal length of 525 px (quanta of disparity)."""

    @property
    def frames(self) -> int:
        """Over how many frames the noise is a mean, at most 10; 0 when no frame told of it."""

    @property
    def up(self) -> tuple[float, float, float] | None:
        """The direction against gravity: a unit vector in the camera frame. None when no frame told it clearly."""

    def __eq__(self, value: object, /) -> bool: ...

@final
class Found:
    """What was found in a frame."""

    @property
    def capture(self) -> Capture: ...
    def labels(self) -> NDArray[np.uint16]: ...
    def structure(self) -> NDArray[np.uint16]: ...
    def columns(self) -> dict[str, NDArray[Any]]: ...
    def parents(self) -> list[list[int]]: ...
    def up(self) -> NDArray[np.float32]: ...
    def estimates(self) -> Estimates | None: ...
    def planes(self) -> NDArray[np.float32]: ...
    def notices(self) -> list[str]: ...
    def points(self, id: int) -> NDArray[np.float32]: ...
    def stages(self) -> dict[str, NDArray[Any]]: ...
    def explain(self, column: int, row: int) -> str: ...
    def scene(self) -> str: ...
    def coco(self, image_id: int, first_id: int) -> str: ...
    def label_png(self) -> bytes: ...
    def overlay_png(self) -> bytes: ...
    def overlay(self) -> NDArray[np.uint8]: ...
    def params(self) -> str: ...
    def fingerprint(self) -> str: ...

@final
class Pipeline:
    """Finds the objects of frames, and keeps the outputs of all stages for the last one."""

    def __new__(cls, params: str, threads: int | None) -> Pipeline: ...
    def discover(self, capture: Capture, estimates: Estimates | None) -> Found: ...
    def set(self, params: str) -> Found | None: ...
    @property
    def params(self) -> str: ...

@final
class Source:
    """The frames of a file or a folder, found but not read."""

    def __new__(
        cls,
        path: str | PathLike[str],
        camera: tuple[float, float, float, float] | str | PathLike[str] | None,
        depth_scale: float | None,
        max_pixels: int | None,
        topics: list[str],
        frames: str | None,
        time: str | None,
    ) -> Source: ...
    @staticmethod
    def of_images(
        images: list[tuple[str | PathLike[str] | None, str | PathLike[str]]],
        camera: tuple[float, float, float, float] | str | PathLike[str] | None,
        depth_scale: float | None,
        max_pixels: int | None,
    ) -> Source: ...
    def __len__(self) -> int: ...
    def read(self, index: int) -> Capture: ...
    def name(self, index: int) -> tuple[str, PathLike[str]]: ...
    def number(self, index: int) -> int: ...
    def files(self, index: int) -> list[PathLike[str]]: ...
    def fingerprint(self, index: int, settings: str) -> str: ...
    def stamp_ns(self, index: int) -> int | None: ...
    @property
    def notices(self) -> list[str]: ...

@final
class Tracked:
    """What the tracker says of a frame."""

    def labels(self) -> NDArray[np.uint16]: ...
    def data(self) -> str: ...

@final
class Tracker:
    """Follows objects through a video."""

    def __new__(cls, params: str, threads: int | None) -> Tracker: ...
    def update(
        self,
        capture: Capture,
        stamp_s: float,
        pose: tuple[list[float], list[float]] | None,
    ) -> Tracked: ...
    def finish(self) -> str: ...
    def skip(self) -> None: ...
    def reset(self) -> None: ...

def parameter_table() -> str: ...
def params_from_toml(text: str) -> str: ...
def params_to_toml(json: str) -> str: ...
def params_with_profile(json: str, profile: str) -> str: ...
def read_images(
    depth: str | PathLike[str],
    color: str | PathLike[str] | None,
    camera: tuple[float, float, float, float] | str | PathLike[str] | None,
    depth_scale: float | None,
    max_pixels: int | None,
) -> Capture: ...
def score(
    labels: NDArray[np.uint16],
    truth: NDArray[np.uint32],
    ignore: int | None,
    background: int | None,
) -> str: ...
def score_mosd(labels: NDArray[np.uint16], truth: NDArray[np.uint32]) -> str: ...
def synthetic(family: str, seed: int, sensor: str) -> Capture: ...
def write_together(files: list[tuple[str | PathLike[str], bytes]]) -> None: ...
def read_camera(path: str | PathLike[str]) -> tuple[tuple[float, float, float, float], float | None]: ...
def extensions() -> list[str]: ...
