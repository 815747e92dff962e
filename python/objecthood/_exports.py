"""Discoveries in the forms of other packages. Each package is imported when it is asked for."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from objecthood.discovery import Discovery


class CocoImage(TypedDict):
    """What a COCO file has of one image, and the one category."""

    image: dict[str, Any]
    annotations: list[dict[str, Any]]
    categories: list[dict[str, Any]]


def coco(found: Discovery, image_id: int, first_id: int) -> CocoImage:
    height, width = found.capture.shape
    annotations = [
        {
            "id": first_id + row,
            "image_id": image_id,
            "category_id": 1,
            "bbox": [thing.xyxy[0].item(), thing.xyxy[1].item(), *(thing.xyxy[2:] - thing.xyxy[:2]).tolist()],
            "area": thing.size_px,
            "segmentation": {"size": [height, width], "counts": run_lengths(thing.mask())},
            # Run lengths of one object, not of a crowd: readers of COCO take them all the same.
            "iscrowd": 0,
            "score": thing.objectness,
        }
        for row, thing in enumerate(found)
    ]
    image = {"id": image_id, "width": width, "height": height, "file_name": found.capture.path}
    return {"image": image, "annotations": annotations, "categories": [{"id": 1, "name": "object"}]}


def run_lengths(mask: NDArray[np.bool_]) -> list[int]:
    """Lengths of the runs of equal pixels, column by column; the first is of pixels that are not set."""
    pixels = mask.ravel(order="F")
    changes = np.flatnonzero(pixels[1:] != pixels[:-1]) + 1
    lengths: list[int] = np.diff(np.concatenate(([0], changes, [pixels.size]))).tolist()
    return [0, *lengths] if pixels[0] else lengths


def supervision(found: Discovery) -> Any:
    masks = found.labels[None] == found.ids[:, None, None]
    return _package("supervision").Detections(
        xyxy=found.xyxy,
        mask=masks,
        confidence=found.objectness,
        class_id=np.zeros(len(found), dtype=int),
        data={"id": found.ids, "centroid": found.centroids},
    )


def pandas(found: Discovery) -> Any:
    from objecthood.discovery import PARTS

    columns: dict[str, Any] = {"id": found.ids, "objectness": found.objectness, "size_px": found.size_px}
    columns |= dict(zip(PARTS, found.parts.T, strict=True))
    columns |= dict(zip(("left_px", "top_px", "right_px", "bottom_px"), found.xyxy.T, strict=True))
    for name, values in (("centroid", found.centroids), ("box_center", found.boxes3d.center), ("box_size", found.boxes3d.size)):
        columns |= {f"{name}_{axis}_m": values[:, k] for k, axis in enumerate("xyz")}
    columns |= {"top_m": found.tops, "flat": found.flat, "parents": found.parents}
    return _package("pandas").DataFrame(columns)


def open3d(found: Discovery) -> list[tuple[Any, Any]]:
    package = _package("open3d")
    color = found.capture.color
    things = []
    for thing in found:
        cloud = package.geometry.PointCloud(package.utility.Vector3dVector(thing.points().astype(np.float64)))
        if color is not None:
            # A pixel of an object has depth, so points and pixels are the same.
            cloud.colors = package.utility.Vector3dVector(color[thing.mask()] / 255.0)
        box = thing.box3d
        sides = (box.center.astype(np.float64), box.rotation.astype(np.float64), box.size.astype(np.float64))
        things.append((cloud, package.geometry.OrientedBoundingBox(*sides)))
    return things


def plot(found: Discovery, ax: Any) -> Any:
    if ax is None:
        ax = _package("matplotlib.pyplot").figure().add_subplot()
    ax.imshow(found.overlay())
    ax.set_axis_off()
    ax.set_title(f"{len(found)} objects")
    return ax


def _package(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        package = name.partition(".")[0]
        raise ImportError(f"this needs the package {package}: pip install {package}") from missing
