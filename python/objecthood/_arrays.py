"""Checks arrays before they go to the native half: C-contiguous, aligned, in native byte order."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from objecthood._native import Capture
from objecthood.errors import InputError

DepthArray: TypeAlias = Union[NDArray[np.float32], NDArray[np.uint16]]
Gravity: TypeAlias = Union[ArrayLike, Literal["poses"]]

#: The most pixels of an image: 2^28, so that indices of pixels and of their edges fit 32 bits.
MAX_PIXELS = 1 << 28


def capture_of(
    depth: DepthArray | Capture,
    K: ArrayLike | None = None,
    *,
    color: NDArray[np.uint8] | None = None,
    depth_scale: float | None = None,
    gravity: Gravity | None = None,
) -> Capture:
    """The frame that these make. A capture of a file is taken as it is."""
    if isinstance(depth, Capture):
        if K is not None or color is not None or depth_scale is not None:
            raise TypeError("a Capture has its own camera, colour and unit: leave out K, color and depth_scale")
        capture = depth
    else:
        capture = _of_arrays(depth, K, color, depth_scale)
    if gravity is None:
        return capture
    if isinstance(gravity, str):
        if gravity != "poses":
            raise InputError(f"gravity is {gravity!r}: give three numbers, or 'poses'")
        return capture.with_gravity_of_pose()
    return capture.with_gravity(_direction(gravity))


def _of_arrays(depth: DepthArray, K: ArrayLike | None, color: NDArray[np.uint8] | None, scale: float | None) -> Capture:
    if K is None:
        raise TypeError("K is missing: give the camera as a 3x3 matrix, or as (fx, fy, cx, cy) in pixels")
    camera = camera_of(K)
    if scale is not None and not (np.isfinite(scale) and scale > 0):
        raise InputError(f"depth_scale is {scale}: give the number of depth units in a metre, 1000 for millimetres")
    image = _image("depth", depth, 2, "HxW")
    pixels = None if color is None else _image("color", color, 3, "HxWx3")
    if pixels is not None and (pixels.dtype != np.uint8 or pixels.shape[2] != 3):
        raise InputError(f"color is {_what(pixels)}: give HxWx3 uint8, RGB")
    if image.dtype == np.float32:
        return Capture.of_floats(image, camera, pixels, scale)
    if image.dtype != np.uint16:
        raise InputError(
            f"depth is {_what(image)}: give float32 in metres (depth.astype(numpy.float32)), or uint16 with depth_scale"
        )
    if scale is None:
        raise InputError(
            "depth is uint16 and depth_scale is missing: say how many units are a metre, 1000 for millimetres, "
            "5000 for TUM, 10000 for YCB-Video"
        )
    return Capture.of_integers(image, camera, pixels, scale)


def _image(name: str, image: Any, dimensions: int, shape: str) -> NDArray[Any]:
    """An image that the native half can read; a copy only when its memory is in another order."""
    if not isinstance(image, np.ndarray):
        raise InputError(f"{name} is {type(image).__name__}: give a NumPy array, {shape} (numpy.asarray({name}))")
    if isinstance(image, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array: fill it, with 0 where there is no depth ({name}.filled(0))")
    if image.ndim != dimensions or 0 in image.shape:
        raise InputError(f"{name} is {_what(image)}: give {shape} with at least one pixel")
    if image.shape[0] * image.shape[1] > MAX_PIXELS:
        raise InputError(f"{name} is {_what(image)}: an image has at most 2^28 pixels")
    if image.dtype.hasobject or image.dtype.names is not None:
        raise InputError(f"{name} holds {image.dtype}: give plain numbers")
    return np.require(image, dtype=image.dtype.newbyteorder("="), requirements=["C", "A"]).view(np.ndarray)


def camera_of(K: ArrayLike) -> tuple[float, float, float, float]:
    """Focal lengths and principal point of a 3x3 matrix, or of four numbers."""
    try:
        matrix = np.asarray(K, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("K is no camera: give a 3x3 matrix, or (fx, fy, cx, cy) in pixels") from None
    if matrix.shape == (4,):
        fx, fy, cx, cy = matrix.tolist()
        return fx, fy, cx, cy
    if matrix.shape != (3, 3):
        raise InputError(f"K has shape {matrix.shape}: give a 3x3 matrix, or (fx, fy, cx, cy) in pixels")
    if matrix[0, 1] != 0 or matrix[1, 0] != 0 or matrix[2].tolist() != [0, 0, 1]:
        raise InputError("K is not [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]: a camera with skew is not read; rectify the images")
    return float(matrix[0, 0]), float(matrix[1, 1]), float(matrix[0, 2]), float(matrix[1, 2])


def _direction(gravity: ArrayLike) -> tuple[float, float, float]:
    try:
        x, y, z = np.asarray(gravity, dtype=np.float64).tolist()
        return float(x), float(y), float(z)
    except (TypeError, ValueError):
        raise InputError("gravity is no direction: give three numbers, (0, 9.81, 0) for a level camera") from None


def _what(array: NDArray[Any]) -> str:
    return f"{array.dtype} of shape {array.shape}"
