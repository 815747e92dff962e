"""What was found in a frame: columns, objects, and the forms that other programs read."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from objecthood import _native
from objecthood._native import Capture, Estimates
from objecthood.params import Params

if TYPE_CHECKING:
    from objecthood._exports import CocoImage

#: What an objectness is made of, in the order of the columns of `Discovery.parts`.
PARTS = ("size", "support", "footing", "compactness", "separation", "visibility")


@dataclass(frozen=True)
class Boxes:
    """Oriented boxes in the camera frame, one axis along up. Row k is the box of object k."""

    center: NDArray[np.float32]
    """Nx3 (m)."""
    size: NDArray[np.float32]
    """Nx3: lengths along the axes of the box (m)."""
    rotation: NDArray[np.float32]
    """Nx3x3: takes the axes of the box to the camera frame."""


@dataclass(frozen=True)
class SupportEdge:
    """One thing that carries another. Lower and upper are nodes: indices into `Discovery.support_nodes`."""

    lower: int
    upper: int
    kind: str
    """on, in or leans."""
    confidence: float
    hidden: bool
    contacts: int


class Discovery:
    """Everything found in one frame.

    It is a sequence of objects, the surest first, and has their properties as columns: row k belongs to object k, whose number in
    `labels` is `ids[k]`. Lengths are metres in the camera frame: x right, y down, z forward.
    """

    def __init__(self, found: _native.Found) -> None:
        self._found = found

    @property
    def capture(self) -> Capture:
        """The frame."""
        return self._found.capture

    @property
    def params(self) -> Params:
        """The parameters with which it was found."""
        return Params.from_json(self._found.params())

    @property
    def fingerprint(self) -> str:
        """SHA-256 of all parameters, as in the scene file."""
        return self._found.fingerprint()

    @cached_property
    def labels(self) -> NDArray[np.uint16]:
        """HxW: the object of every pixel, 0 = none."""
        return self._found.labels()

    @cached_property
    def structure(self) -> NDArray[np.uint16]:
        """HxW: the large plane of every pixel (table, floor, wall), 0 = none, k = row k - 1 of `planes`."""
        return self._found.structure()

    @cached_property
    def planes(self) -> NDArray[np.float32]:
        """Mx4: unit normal and offset (m) of each large plane; the points X with normal · X + offset = 0."""
        return self._found.planes()

    @cached_property
    def up(self) -> NDArray[np.float32]:
        """The direction against gravity: a unit vector."""
        return self._found.up()

    @cached_property
    def estimates(self) -> Estimates | None:
        """What this frame, and those before it that were handed on, tell of the sensor's noise and of up. `discover` takes it with the next
        frame of the same camera. None for the method paper."""
        return self._found.estimates()

    @cached_property
    def notices(self) -> list[str]:
        """What you should know of this result."""
        return self._found.notices()

    @cached_property
    def _columns(self) -> dict[str, NDArray[Any]]:
        return self._found.columns()

    @property
    def ids(self) -> NDArray[np.uint16]:
        """N: the number of each object in `labels`."""
        return self._columns["ids"]

    @property
    def objectness(self) -> NDArray[np.float32]:
        """N: how sure each object is, in [0, 1]."""
        return self._columns["objectness"]

    @property
    def parts(self) -> NDArray[np.float32]:
        """Nx6: what the objectness is made of, in the order of `objecthood.PARTS`; 1 speaks for an object."""
        return self._columns["parts"]

    @property
    def size_px(self) -> NDArray[np.int64]:
        """N: pixels of each object."""
        return self._columns["size_px"]

    @property
    def xyxy(self) -> NDArray[np.float32]:
        """Nx4: left, top, right and bottom of the box around the pixels (px); right and bottom are excluded."""
        return self._columns["xyxy"]

    @property
    def centroids(self) -> NDArray[np.float32]:
        """Nx3: the mean of the points (m)."""
        return self._columns["centroids"]

    @property
    def tops(self) -> NDArray[np.float32]:
        """N: how high each object stands above what carries it (m), NaN where that is not known."""
        return self._columns["tops"]

    @property
    def flat(self) -> NDArray[np.bool_]:
        """N: whether it is a thing 0.2 to 12 mm thick that lies flat."""
        return self._columns["flat"]

    @cached_property
    def boxes3d(self) -> Boxes:
        """The oriented boxes."""
        columns = self._columns
        return Boxes(columns["box_centers"], columns["box_sizes"], _matrices(columns["box_quaternions"]))

    @cached_property
    def parents(self) -> list[list[int]]:
        """What each object stands on, lies in or leans on: numbers of objects; 0 = structure or another surface."""
        return self._found.parents()

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The content of the scene file (docs/scene.schema.json)."""
        scene: dict[str, Any] = json.loads(self.to_json())
        return scene

    @property
    def support_nodes(self) -> list[dict[str, Any]]:
        """The nodes of the support graph: objects, structure, and other surfaces."""
        nodes: list[dict[str, Any]] = self.scene["support"]["nodes"]
        return nodes

    @property
    def support(self) -> list[SupportEdge]:
        """The edges of the support graph."""
        return [SupportEdge(**edge) for edge in self.scene["support"]["edges"]]

    @cached_property
    def stages(self) -> dict[str, NDArray[Any]]:
        """The images that the stages put out, made when asked: normals HxWx3, regions HxW with -1 = none. Runs the method once more."""
        return self._found.stages()

    def explain(self, x: int, y: int) -> dict[str, Any]:
        """Why the pixel in column x and row y is what it is, and which parameter would have to change for another answer. Takes the time
        of up to 17 frames. Only for the method context."""
        explanation: dict[str, Any] = json.loads(self._found.explain(x, y))
        return explanation

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[Object]:
        return (Object(self, row) for row in range(len(self)))

    @overload
    def __getitem__(self, rows: int) -> Object: ...
    @overload
    def __getitem__(self, rows: slice | NDArray[Any]) -> list[Object]: ...
    def __getitem__(self, rows: int | slice | NDArray[Any]) -> Object | list[Object]:
        """One object, or those of a slice, of a mask such as `found.objectness > 0.8`, or of row numbers."""
        chosen = np.arange(len(self))[rows]
        if chosen.ndim == 0:
            return Object(self, int(chosen))
        return [Object(self, row) for row in chosen.tolist()]

    def __repr__(self) -> str:
        height, width = self.capture.shape
        return f"<objecthood.Discovery of {len(self)} objects in {width}x{height} px>"

    def _repr_html_(self) -> str:
        picture = base64.b64encode(self._found.overlay_png()).decode()
        rows = "".join(
            f"<tr><td>{o.id}</td><td>{o.objectness:.2f}</td><td>{o.size_px}</td>"
            f"<td>{' x '.join(f'{side:.2f}' for side in o.box3d.size)}</td></tr>"
            for o in self
        )
        head = "<tr><th>id</th><th>objectness</th><th>pixels</th><th>size [m]</th></tr>"
        return f'<img src="data:image/png;base64,{picture}"><table>{head}{rows}</table>'

    def to_json(self) -> str:
        """The scene file, as the command line writes it."""
        return self._found.scene()

    def overlay(self) -> NDArray[np.uint8]:
        """HxWx3: the image with the outline and the number of every object."""
        return self._found.overlay()

    def save(self, folder: str | PathLike[str], name: str | None = None) -> list[Path]:
        """Writes NAME.labels.png, NAME.json and NAME.overlay.png, all or none. The name is the frame's own, or `frame`."""
        stem = name or self.capture.name or "frame"
        Path(folder).mkdir(parents=True, exist_ok=True)
        contents = {
            ".labels.png": self._found.label_png(),
            ".json": self.to_json().encode(),
            ".overlay.png": self._found.overlay_png(),
        }
        files = [(Path(folder) / (stem + ending), content) for ending, content in contents.items()]
        _native.write_together(list(files))
        return [path for path, _ in files]

    def to_coco(self, image_id: int = 1, first_id: int = 1) -> CocoImage:
        """The image and its annotations as COCO has them: boxes x, y, width, height; masks as compressed run lengths, which
        pycocotools decodes; `score` is the objectness, `label` the number in the label image."""
        content: CocoImage = json.loads(self._found.coco(image_id, first_id))
        return content

    def to_supervision(self) -> Any:
        """`supervision.Detections` with masks. Needs the package supervision."""
        from objecthood._exports import supervision

        return supervision(self)

    def to_open3d(self) -> tuple[Any, list[Any]]:
        """The points and a box for each object: an `open3d.t.geometry.PointCloud` with `positions` (m), `label` and `colors`, and a list of
        `open3d.geometry.OrientedBoundingBox`. Needs the package open3d."""
        from objecthood._exports import open3d

        return open3d(self)

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` with a row for each object. Needs the package pandas."""
        from objecthood._exports import pandas

        return pandas(self)

    def plot(self, ax: Any = None) -> Any:
        """Draws `overlay` into matplotlib axes, which are made unless given, and returns them. Needs the package matplotlib."""
        from objecthood._exports import plot

        return plot(self, ax)


class Object:
    """One object of a discovery."""

    def __init__(self, discovery: Discovery, row: int) -> None:
        self._discovery = discovery
        self._row = row

    @property
    def id(self) -> int:
        """Its number in `Discovery.labels`."""
        return int(self._discovery.ids[self._row])

    @property
    def objectness(self) -> float:
        """How sure it is, in [0, 1]."""
        return float(self._discovery.objectness[self._row])

    @property
    def parts(self) -> dict[str, float]:
        """What its objectness is made of."""
        return dict(zip(PARTS, self._discovery.parts[self._row].tolist(), strict=True))

    @property
    def size_px(self) -> int:
        """Its pixels."""
        return int(self._discovery.size_px[self._row])

    @property
    def xyxy(self) -> NDArray[np.float32]:
        """Left, top, right and bottom (px); right and bottom are excluded."""
        xyxy: NDArray[np.float32] = self._discovery.xyxy[self._row]
        return xyxy

    @property
    def centroid(self) -> NDArray[np.float32]:
        """The mean of its points (m)."""
        centroid: NDArray[np.float32] = self._discovery.centroids[self._row]
        return centroid

    @property
    def box3d(self) -> Boxes:
        """Its oriented box: centre 3, size 3, rotation 3x3."""
        boxes = self._discovery.boxes3d
        return Boxes(boxes.center[self._row], boxes.size[self._row], boxes.rotation[self._row])

    @property
    def top(self) -> float:
        """How high it stands above what carries it (m), NaN where that is not known."""
        return float(self._discovery.tops[self._row])

    @property
    def parents(self) -> list[int]:
        """Numbers of the objects that it stands on; 0 = structure or another surface."""
        return self._discovery.parents[self._row]

    def mask(self) -> NDArray[np.bool_]:
        """HxW: its pixels. Made anew at each call."""
        mask: NDArray[np.bool_] = self._discovery.labels == self.id
        return mask

    def points(self) -> NDArray[np.float32]:
        """Nx3: its points (m), row by row as its pixels in `mask`."""
        return self._discovery._found.points(self.id)

    def __repr__(self) -> str:
        return f"<objecthood.Object {self.id}: objectness {self.objectness:.2f}, {self.size_px} px>"


def _matrices(xyzw: NDArray[np.float32]) -> NDArray[np.float32]:
    """Rotation matrices of unit quaternions, Nx4 -> Nx3x3."""
    x, y, z, w = xyzw.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows, dtype=np.float32), 2, 0)
