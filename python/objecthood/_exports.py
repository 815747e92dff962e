"""Discoveries in the forms of other packages. Each package is imported when it is asked for."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

if TYPE_CHECKING:
    from objecthood.discovery import Discovery


class CocoImage(TypedDict):
    """What a COCO file has of one image, and the one category."""

    image: dict[str, Any]
    annotations: list[dict[str, Any]]
    categories: list[dict[str, Any]]


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


def open3d(found: Discovery) -> tuple[Any, list[Any]]:
    package = _package("open3d")
    depth, color = found.capture.depth, found.capture.color
    fx, fy, cx, cy = found.capture.camera
    rows, columns = np.nonzero(np.isfinite(depth))
    z = depth[rows, columns]
    positions = np.stack([(columns - cx) / fx * z, (rows - cy) / fy * z, z], axis=1)
    cloud = package.t.geometry.PointCloud(positions.astype(np.float32))
    cloud.point["label"] = found.labels[rows, columns, None].astype(np.int32)
    if color is not None:
        cloud.point["colors"] = color[rows, columns]
    boxes = zip(found.boxes3d.center, found.boxes3d.rotation, found.boxes3d.size, strict=True)
    return cloud, [package.geometry.OrientedBoundingBox(*box) for box in boxes]


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
