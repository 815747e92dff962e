"""Archives of frames: found below paths and URIs, and brought to this machine as far as they are read."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Union

import pyarrow.fs as pafs

from objecthood import _native
from objecthood.errors import FileError, InputError
from objecthood.files import Camera, Source, camera_source

#: A path or URI of a file or folder, or the images of a frame: colour (or None) and depth.
Input = Union[str, "os.PathLike[str]", tuple[Union[str, "os.PathLike[str]", None], Union[str, "os.PathLike[str]"]]]

#: What tells that a folder has a layout that is read as a whole: all names of one of these.
LAYOUTS = ({"rgb.txt", "depth.txt"}, {"scene_camera.json"}, {"metadata.yaml"})

#: Endings of the files of such a folder that are read to list its frames.
LISTS = {".txt", ".json", ".yaml", ".yml"}


@dataclass(frozen=True)
class File:
    """A file of an archive."""

    path: str
    size: int
    changed_ns: int


@dataclass(frozen=True)
class Given:
    """What the caller knows better than the files."""

    camera: tuple[float, float, float, float] | None = None
    depth_scale: float | None = None
    topics: tuple[str, ...] = ()

    @classmethod
    def of(cls, camera: Camera | None, depth_scale: float | None, topics: Iterable[str]) -> Given:
        known = camera_source(camera)
        if isinstance(known, (str, os.PathLike)):
            # Workers on other machines do not have the file.
            known, said = _native.read_camera(known)
            depth_scale = said if depth_scale is None else depth_scale
        return cls(known, depth_scale, tuple(topics))


@dataclass(frozen=True)
class Unit:
    """What is opened at once: a file, a folder with a layout, or the images of a frame."""

    #: The input that it is from, as the user named it.
    group: str
    #: How a user would name it.
    uri: str
    filesystem: Any
    path: str
    #: Its files, where they have to be copied to this machine.
    files: tuple[File, ...]
    #: Paths of colour and depth.
    images: tuple[str | None, str] | None = None

    @property
    def is_local(self) -> bool:
        return isinstance(self.filesystem, pafs.LocalFileSystem)


def place(path: str | os.PathLike[str]) -> tuple[Any, str]:
    """The file system of a path or URI, and the path in it."""
    text = os.fspath(path)
    try:
        if "://" in text:
            filesystem, inside = pafs.FileSystem.from_uri(text)
            return filesystem, inside
        return pafs.LocalFileSystem(), os.path.abspath(text)
    except (ValueError, OSError) as error:
        raise InputError(f"{text}: no file system is known for it ({error}): give a path, s3://.. or gs://..") from None


def find(inputs: Input | list[Input]) -> Iterator[Unit]:
    """What lies below the inputs, in the order of the inputs and of the paths."""
    for given in [inputs] if isinstance(inputs, (str, os.PathLike, tuple)) else inputs:
        if isinstance(given, tuple):
            yield _pair(*given)
        else:
            yield from _below(os.fspath(given))


def _pair(color: str | os.PathLike[str] | None, depth: str | os.PathLike[str]) -> Unit:
    filesystem, path = place(depth)
    beside = None if color is None else place(color)[1]
    files = _copied(filesystem, map(_file, filesystem.get_file_info([p for p in (beside, path) if p is not None])))
    parent = os.fspath(depth).partition("?")[0].rpartition("/")[0] or "."
    return Unit(parent, os.fspath(depth), filesystem, path, files, (beside, path))


def _below(uri: str) -> Iterator[Unit]:
    filesystem, top = place(uri)
    info = filesystem.get_file_info(top)
    if info.type == pafs.FileType.NotFound:
        raise FileError(f"{uri}: cannot be read: there is nothing; check the path and that you may read it")
    if info.is_file:
        yield Unit(uri, uri, filesystem, top, _copied(filesystem, [_file(info)]))
        return
    found = filesystem.get_file_info(pafs.FileSelector(top, recursive=True))
    files = sorted((_file(info) for info in found if info.is_file), key=lambda file: file.path)
    names: dict[str, set[str]] = {}
    for file in files:
        folder, _, name = file.path.rpartition("/")
        names.setdefault(folder, set()).add(name)
    layouts = {folder for folder, has in names.items() if any(layout <= has for layout in LAYOUTS)}
    parts: dict[str, list[File]] = {}
    for file in files:
        owners = [str(parent) for parent in PurePosixPath(file.path).parents if str(parent) in layouts]
        if owners:
            parts.setdefault(owners[-1], []).append(file)
        elif PurePosixPath(file.path).suffix.lower().lstrip(".") in _native.extensions():
            parts[file.path] = [file]
    base, _, query = uri.partition("?")
    for path, own in parts.items():
        rest = path[len(top.rstrip("/")) :]
        yield Unit(uri, base.rstrip("/") + rest + (f"?{query}" if query else ""), filesystem, path, _copied(filesystem, own))
    if not parts:
        raise FileError(f"{uri}: holds no file or folder of a format that is read (docs/INPUTS.md)")


def _copied(filesystem: Any, files: Iterable[File]) -> tuple[File, ...]:
    return () if isinstance(filesystem, pafs.LocalFileSystem) else tuple(files)


def _file(info: Any) -> File:
    return File(info.path, info.size or 0, info.mtime_ns or 0)


class Opened:
    """The frames of a unit. What is not on this machine is copied to a temporary folder, each file when a frame needs it; until then
    an empty file of its size and time stands for it."""

    def __init__(self, unit: Unit, given: Given) -> None:
        self._unit = unit
        self._copies: Path | None = None
        self._absent: dict[str, File] = {}
        if not unit.is_local:
            self._copies = Path(tempfile.mkdtemp(prefix="objecthood-"))
            self._stand_in()
        camera, scale = given.camera, given.depth_scale
        if unit.images is None:
            native = _native.Source(self._local(unit.path), camera, scale, None, list(given.topics), None, None)
        else:
            color, depth = unit.images
            native = _native.Source.of_images([(color and self._local(color), self._local(depth))], camera, scale, None)
        self._native = native

    def __len__(self) -> int:
        return len(self._native)

    def frame(self, index: int) -> str:
        """What a frame is called in the whole archive."""
        return self._unit.uri if self._unit.images else f"{self._unit.uri}#{self._native.number(index):07d}"

    def fingerprint(self, index: int, settings: str) -> str:
        """What decides the result of a frame."""
        return self._native.fingerprint(index, settings)

    def read(self, index: int) -> _native.Capture:
        """Reads a frame."""
        for path in self._native.files(index):
            self._fetch(os.fspath(path))
        return self._native.read(index)

    def close(self) -> None:
        """Removes the copies."""
        if self._copies is not None:
            shutil.rmtree(self._copies, ignore_errors=True)

    def _local(self, path: str) -> str:
        return path if self._copies is None else str(self._copies / path.lstrip("/"))

    def _stand_in(self) -> None:
        alone = self._unit.images is None and len(self._unit.files) == 1
        for file in self._unit.files:
            local = self._local(file.path)
            os.makedirs(os.path.dirname(local), exist_ok=True)
            with open(local, "wb") as made:
                made.truncate(file.size)
            os.utime(local, ns=(file.changed_ns, file.changed_ns))
            self._absent[local] = file
            if alone or Path(local).suffix.lower() in LISTS | {".db3"}:
                self._fetch(local)

    def _fetch(self, local: str) -> None:
        file = self._absent.pop(local, None)
        if file is None:
            return
        with self._unit.filesystem.open_input_stream(file.path) as remote, open(local, "wb") as copy:
            shutil.copyfileobj(remote, copy, 1 << 20)
        os.utime(local, ns=(file.changed_ns, file.changed_ns))
