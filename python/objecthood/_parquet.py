"""The Parquet data set of a batch: parts that appear whole, one row a frame."""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.fs as pafs
import pyarrow.parquet as pq

from objecthood._archive import place
from objecthood.discovery import Discovery

#: The folder of the parts, below that of the results. `source=..` below it is a partition as Hive has them.
PARTS = "frames"

_vector = pa.list_(pa.float32())

OBJECT = pa.struct(
    {
        "id": pa.uint16(),
        "objectness": pa.float32(),
        "size_px": pa.int64(),
        "xyxy": _vector,
        "centroid_m": _vector,
        "box_center_m": _vector,
        "box_size_m": _vector,
        "box_rotation": _vector,
        "parents": pa.list_(pa.uint16()),
    }
)

#: A row a frame; `error` is null when it is done, and everything from `stamp_ns` to `notices` when it failed.
SCHEMA = pa.schema(
    {
        "frame": pa.string(),
        "fingerprint": pa.string(),
        "stamp_ns": pa.int64(),
        "labels_png": pa.binary(),
        "objects": pa.list_(OBJECT),
        "up": _vector,
        "notices": pa.list_(pa.string()),
        "error": pa.string(),
    }
)


def row(frame: str, fingerprint: str, found: Discovery) -> dict[str, Any]:
    """The row of a frame that is done."""
    objects = [
        {
            "id": thing.id,
            "objectness": thing.objectness,
            "size_px": thing.size_px,
            "xyxy": thing.xyxy,
            "centroid_m": thing.centroid,
            "box_center_m": thing.box3d.center,
            "box_size_m": thing.box3d.size,
            "box_rotation": thing.box3d.rotation.ravel(),
            "parents": thing.parents,
        }
        for thing in found
    ]
    return {
        "frame": frame,
        "fingerprint": fingerprint,
        "stamp_ns": found.capture.stamp_ns,
        "labels_png": found._found.label_png(),
        "objects": objects,
        "up": found.up,
        "notices": found.notices,
    }


def failure(frame: str, fingerprint: str, error: BaseException) -> dict[str, Any]:
    """The row of a frame that failed."""
    return {"frame": frame, "fingerprint": fingerprint, "error": f"{type(error).__name__}: {error}"}


@dataclass(frozen=True)
class Known:
    """What the data set says of a frame."""

    fingerprint: str
    is_done: bool


class DataSet:
    """The rows below a folder, which may be a URI."""

    def __init__(self, out: str) -> None:
        self._filesystem, self._top = place(out)

    def write(self, group: str, rows: list[dict[str, Any]]) -> None:
        """Writes rows as a part whose name is told by its frames: written again it is the same file."""
        name = hashlib.sha256("\n".join(row["frame"] + row["fingerprint"] for row in rows).encode()).hexdigest()[:32]
        self._put(f"{self._top}/{PARTS}/source={_slug(group)}/part-{name}.parquet", pa.Table.from_pylist(rows, SCHEMA))

    def known(self, wanted: Mapping[str, str]) -> dict[str, Known]:
        """The frames that have a row, after rows were removed that no longer hold: of `wanted` frames, whose fingerprints are given, with another
        fingerprint, and second rows of a frame."""
        known: dict[str, Known] = {}
        for path in self._parts():
            table = self._get(path, ["frame", "fingerprint", "error"])
            keep = []
            for frame, fingerprint, error in zip(*(table[name].to_pylist() for name in table.column_names), strict=True):
                holds = frame not in known and wanted.get(frame, fingerprint) == fingerprint
                keep.append(holds)
                if holds:
                    known[frame] = Known(fingerprint, error is None)
            if not all(keep):
                self._replace(path, self._get(path).filter(pa.array(keep)))
        return known

    def remove(self, frames: set[str]) -> None:
        """Removes the rows of frames."""
        for path in self._parts() if frames else []:
            hit = pc.is_in(self._get(path, ["frame"])["frame"], pa.array(sorted(frames), pa.string()))
            if pc.any(hit).as_py():
                self._replace(path, self._get(path).filter(pc.invert(hit)))

    def summarize(self, frames: set[str], about: dict[str, Any]) -> dict[str, Any]:
        """Writes summary.json of these frames, and returns it."""
        done = objects = 0
        failures = []
        for path in self._parts():
            table = self._get(path, ["frame", "objects", "error"])
            counts = pc.list_value_length(table["objects"]).to_pylist()
            for frame, count, error in zip(table["frame"].to_pylist(), counts, table["error"].to_pylist(), strict=True):
                if frame in frames and error is None:
                    done, objects = done + 1, objects + (count or 0)
                elif frame in frames:
                    failures.append({"frame": frame, "error": error})
        failures.sort(key=lambda failed: failed["frame"])
        summary = {"frames": len(frames), "done": done, "failed": len(failures), "objects": objects, **about, "failures": failures}
        self._filesystem.create_dir(self._top, recursive=True)
        self._store(f"{self._top}/summary.json", (json.dumps(summary, indent=1) + "\n").encode())
        return summary

    def _parts(self) -> list[str]:
        selector = pafs.FileSelector(f"{self._top}/{PARTS}", recursive=True, allow_not_found=True)
        found = self._filesystem.get_file_info(selector)
        return sorted(info.path for info in found if info.is_file and re.search(r"/part-[0-9a-f]+\.parquet$", info.path))

    def _get(self, path: str, columns: list[str] | None = None) -> Any:
        with self._filesystem.open_input_file(path) as file:
            return pq.ParquetFile(file).read(columns)

    def _replace(self, path: str, table: Any) -> None:
        if table.num_rows:
            self._put(path, table)
        else:
            self._filesystem.delete_file(path)

    def _put(self, path: str, table: Any) -> None:
        buffer = io.BytesIO()
        # PNGs are compressed already.
        pq.write_table(table, buffer, compression={name: "NONE" if name == "labels_png" else "ZSTD" for name in SCHEMA.names})
        self._filesystem.create_dir(path.rpartition("/")[0], recursive=True)
        self._store(path, buffer.getvalue())

    def _store(self, path: str, content: bytes) -> None:
        """A file appears whole or not at all: object stores do so by themselves."""
        local = isinstance(self._filesystem, pafs.LocalFileSystem)
        aside = f"{path}.{hashlib.sha256(content).hexdigest()[:8]}.new" if local else path
        with self._filesystem.open_output_stream(aside) as file:
            file.write(content)
        if local:
            self._filesystem.move(aside, path)


def _slug(group: str) -> str:
    """A short name of an input that is a name of a folder, and no other input's."""
    plain = group.partition("?")[0].rstrip("/")
    return re.sub(r"[^A-Za-z0-9._-]+", "_", plain.rpartition("/")[2])[:40] + "-" + hashlib.sha256(plain.encode()).hexdigest()[:8]
