"""Frames of files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike
from typing import TypeAlias, Union, overload

from numpy.typing import ArrayLike

from objecthood import _native
from objecthood._arrays import camera_of
from objecthood._native import Capture
from objecthood.errors import InputError

Camera: TypeAlias = Union[str, PathLike[str], ArrayLike]


class Source(Sequence[Capture]):
    """The frames of a file or a folder, in their order: found, but read only when asked for.

    A frame that cannot be read raises `FileError` when its turn comes; `source[k]` reaches the others.
    """

    def __init__(self, native: _native.Source) -> None:
        self._native = native

    @property
    def notices(self) -> list[str]:
        """What you should know of the files."""
        return self._native.notices

    def name(self, index: int) -> str:
        """What a frame is called, without reading it."""
        return self._native.name(index)[0]

    def path(self, index: int) -> str:
        """The file of a frame, without reading it."""
        return str(self._native.name(index)[1])

    def stamp_ns(self, index: int) -> int | None:
        """When a frame was measured (ns by the clock of the source), if that is known without reading it."""
        return self._native.stamp_ns(index)

    def __len__(self) -> int:
        return len(self._native)

    @overload
    def __getitem__(self, index: int) -> Capture: ...
    @overload
    def __getitem__(self, index: slice) -> list[Capture]: ...
    def __getitem__(self, index: int | slice) -> Capture | list[Capture]:
        if isinstance(index, slice):
            return [self._native.read(k) for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        return self._native.read(index % len(self))

    def __iter__(self) -> Iterator[Capture]:
        return (self._native.read(k) for k in range(len(self)))

    def __repr__(self) -> str:
        return f"<objecthood.Source of {len(self)} frames>"


def open(
    path: str | PathLike[str],
    *,
    camera: Camera | None = None,
    depth_scale: float | None = None,
    max_pixels: int | None = None,
    topics: Sequence[str] = (),
    frames: str | None = None,
    time: str | None = None,
) -> Source:
    """The frames of a file of any format that is read (docs/INPUTS.md), of a folder with a layout, or of all files below a folder.

    What you know better than the files: `camera` is the path of a camera file, a 3x3 matrix, or (fx, fy, cx, cy) in pixels;
    `depth_scale` is the number of depth units in a metre. Frames of more than `max_pixels` (2^24 unless given) are refused.
    `topics` are those of a recording to be read, where it has several cameras. `frames` selects by number, as "10..200:5" (first..end:step),
    `time` by seconds from the first frame, as "3.0..8.0"; what is left out is not read.
    """
    if isinstance(topics, str):
        raise InputError(f"topics is {topics!r}: give a list of names, [{topics!r}]")
    return Source(_native.Source(path, camera_source(camera), depth_scale, max_pixels, list(topics), frames, time))


def read_images(
    depth: str | PathLike[str],
    color: str | PathLike[str] | None = None,
    *,
    camera: Camera | None,
    depth_scale: float | None = None,
    max_pixels: int | None = None,
) -> Capture:
    """The frame in a depth image and a colour image registered to it. Integer depth needs `depth_scale`, here or in the camera file."""
    return _native.read_images(depth, color, camera_source(camera), depth_scale, max_pixels)


def camera_source(camera: Camera | None) -> str | PathLike[str] | tuple[float, float, float, float] | None:
    """A camera as the native half takes it."""
    return camera if camera is None or isinstance(camera, (str, PathLike)) else camera_of(camera)
