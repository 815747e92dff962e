"""Archives of frames on a cluster, or on one machine: `segment` is a pipeline of Ray Data.

It needs Ray: `pip install "objecthood[ray]"`. `python -m objecthood.ray --help` is the same for the command line.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections import OrderedDict, deque
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from objecthood import _native
from objecthood.errors import FileError, ObjecthoodError
from objecthood.files import Camera
from objecthood.params import Params
from objecthood.pipeline import Pipeline, _params_of

try:
    import pyarrow as pa
    import ray
except ImportError:
    raise ImportError('this needs Ray and PyArrow: pip install "objecthood[ray]"')  # The cause follows by itself.

from objecthood._archive import Given, Input, Opened, Unit, find
from objecthood._parquet import DataSet, failure, row

#: Frames of a part of the data set: few enough that little is lost with a worker, many enough that files are not tiny.
FRAMES_PER_PART = 32

#: Times that a part is tried again when its worker dies.
RETRIES = 3


@dataclass(frozen=True)
class _Frame:
    """A frame to be done; a unit that cannot be opened is one frame, with why."""

    unit: Unit
    index: int
    frame: str
    fingerprint: str
    error: str | None = None


@dataclass(frozen=True)
class _Job:
    """What workers have to know."""

    params: str
    given: Given
    out: str

    @property
    def settings(self) -> str:
        return f"{_native.__version__} {self.params} {self.given}"


def segment(
    inputs: Input | list[Input],
    out: str,
    *,
    method: str | None = None,
    params: Params | None = None,
    camera: Camera | None = None,
    depth_scale: float | None = None,
    topics: Sequence[str] = (),
    concurrency: int | None = None,
) -> dict[str, Any]:
    """Finds the objects of all frames below `inputs`; writes Parquet below `out`, and returns what summary.json says.

    `inputs`: paths or URIs (`s3://..`, `gs://..`) of files and folders, and pairs of a colour image (or None) and a depth image; one, or a list. `out`: a
    folder or URI. `concurrency`: the number of workers, one a CPU of the cluster unless given. `camera` and `depth_scale` as for `objecthood.open`.

    A frame that fails is a row with its `error`. What an earlier call did is not done again, unless its files, the parameters or the version
    have changed; what failed is tried again. Each worker has a warm pipeline of one thread and holds two frames and a part's rows; images do
    not pass through Ray's object store.
    """
    # Workers have working folders of their own.
    out = out if "://" in out else os.path.abspath(out)
    job = _Job(_params_of(params, method, None).to_json(), Given.of(camera, depth_scale, topics), out)
    if not ray.is_initialized():
        ray.init(log_to_driver=False)
    frames = _listed(list(find(inputs)), job)
    wanted = {each.frame: each.fingerprint for each in frames}
    data = DataSet(out)
    known = data.known(wanted)
    data.remove({frame for frame, row in known.items() if frame in wanted and not row.is_done})
    missing = [each for each in frames if each.frame not in known or not known[each.frame].is_done]
    parts = [{"part": ray.cloudpickle.dumps(part)} for part in _parts(missing)]
    if parts:
        workers = max(1, min(concurrency or int(ray.cluster_resources().get("CPU", 1)), len(parts)))
        done = ray.data.from_items(parts, override_num_blocks=len(parts)).map_batches(
            _Worker,
            fn_constructor_args=(job,),
            batch_size=1,
            batch_format="pyarrow",
            compute=ray.data.ActorPoolStrategy(size=workers),
            num_cpus=1,
            ray_remote_args_fn=lambda: {"max_task_retries": RETRIES},
        )
        for _ in done.iter_batches(batch_size=None):
            pass
    # A worker of a driver that was killed may have ended a part meanwhile.
    lost = wanted.keys() - data.known(wanted).keys()
    if lost:
        raise FileError(f"{out}: {len(lost)} frames that workers have done are not there: give a folder or URI that all machines share")
    return data.summarize(set(wanted), {"version": _native.__version__, "parameters": json.loads(job.params)})


def _listed(units: list[Unit], job: _Job) -> list[_Frame]:
    """The frames of the units, in their order."""
    items = [{"place": place, "unit": ray.cloudpickle.dumps(unit)} for place, unit in enumerate(units)]
    if not items:
        return []
    blocks = min(len(items), 4 * int(ray.cluster_resources().get("CPU", 1)))
    rows = ray.data.from_items(items, override_num_blocks=blocks).map(_List(job)).iter_rows()
    lists = {row["place"]: row["frames"] for row in rows}
    return [frame for place in sorted(lists) for frame in ray.cloudpickle.loads(lists[place])]


class _List:
    """Lists the frames of a unit."""

    def __init__(self, job: _Job) -> None:
        self._job = job

    def __call__(self, row: dict[str, Any]) -> dict[str, Any]:
        unit = ray.cloudpickle.loads(row["unit"])
        return {"place": row["place"], "frames": ray.cloudpickle.dumps(list(self._frames(unit)))}

    def _frames(self, unit: Unit) -> Iterable[_Frame]:
        try:
            opened = Opened(unit, self._job.given)
        except (ObjecthoodError, OSError) as error:
            yield _Frame(unit, 0, unit.uri, "", f"{type(error).__name__}: {error}")
            return
        for index in range(len(opened)):
            try:
                yield _Frame(unit, index, opened.frame(index), opened.fingerprint(index, self._job.settings))
            except (ObjecthoodError, OSError) as error:
                yield _Frame(unit, index, f"{unit.uri}#{index:07d}", "", f"{type(error).__name__}: {error}")
        opened.close()


def _parts(frames: list[_Frame]) -> Iterable[list[_Frame]]:
    """Frames of one input that become one file."""
    groups: dict[str, list[_Frame]] = {}
    for frame in frames:
        groups.setdefault(frame.unit.group, []).append(frame)
    for group in groups.values():
        yield from (group[k : k + FRAMES_PER_PART] for k in range(0, len(group), FRAMES_PER_PART))


class _Worker:
    """Does parts. It reads the next frame while it looks at one."""

    #: Units that stay open.
    OPEN = 2

    def __init__(self, job: _Job) -> None:
        self._job = job
        self._pipeline = Pipeline(Params.from_json(job.params), threads=1)
        self._data = DataSet(job.out)
        self._reader = ThreadPoolExecutor(1)
        self._opened: OrderedDict[str, Opened] = OrderedDict()

    def __call__(self, batch: Any) -> Any:
        for pickled in batch["part"].to_pylist():
            part: list[_Frame] = ray.cloudpickle.loads(pickled)
            rows = []
            coming = deque([self._reader.submit(self._read, part[0])])
            for frame, following in zip(part, [*part[1:], None], strict=True):
                if following is not None:
                    coming.append(self._reader.submit(self._read, following))
                rows.append(self._row(frame, coming.popleft()))
            self._data.write(part[0].unit.group, rows)
        return pa.table({"rows": [len(rows)]})

    def _read(self, frame: _Frame) -> _native.Capture:
        opened = self._opened.pop(frame.unit.uri, None)
        if opened is None:
            while len(self._opened) >= self.OPEN:
                self._opened.popitem(last=False)[1].close()
            opened = Opened(frame.unit, self._job.given)
        self._opened[frame.unit.uri] = opened
        return opened.read(frame.index)

    def _row(self, frame: _Frame, read: Future[_native.Capture]) -> dict[str, Any]:
        if frame.error is not None:
            read.exception()
            return {"frame": frame.frame, "fingerprint": frame.fingerprint, "error": frame.error}
        try:
            return row(frame.frame, frame.fingerprint, self._pipeline.discover(read.result()))
        except Exception as error:  # Whatever is wrong with one frame, the others are to be done.
            return failure(frame.frame, frame.fingerprint, error)


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m objecthood.ray`: 0 when every frame is done, 1 when some failed, 2 when nothing could be done."""
    parser = argparse.ArgumentParser(prog="python -m objecthood.ray", description=segment.__doc__)
    named = parser.add_mutually_exclusive_group(required=True)
    named.add_argument("inputs", nargs="*", default=[], help="paths or URIs of files and folders")
    named.add_argument("--pairs", action="store_true", help="read pairs of images from stdin: JSON, a list of [colour or null, depth]")
    parser.add_argument("--out", required=True, help="folder or URI of the Parquet data set")
    parser.add_argument("--params", type=Params.from_json, help="JSON of parameters, as Params.to_json gives it")
    parser.add_argument("--camera", help="camera file, or fx,fy,cx,cy")
    parser.add_argument("--depth-scale", type=float)
    parser.add_argument("--topic", action="append", default=[])
    parser.add_argument("--workers", type=int, help="number of workers; one a CPU of the cluster, unless given")
    given = parser.parse_args(arguments)
    try:
        numbers = (given.camera or "").split(",")
        camera = [float(number) for number in numbers] if len(numbers) == 4 else given.camera
        summary = segment(
            [tuple(pair) for pair in json.load(sys.stdin)] if given.pairs else given.inputs,
            given.out,
            params=given.params,
            camera=camera,
            depth_scale=given.depth_scale,
            topics=given.topic,
            concurrency=given.workers,
        )
    except (ObjecthoodError, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for failed in summary["failures"]:
        print(f"error: {failed['frame']}: {failed['error']}", file=sys.stderr)
    print(f"{summary['done']} of {summary['frames']} frames done, {summary['failed']} failed, {summary['objects']} objects -> {given.out}")
    return 1 if summary["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
