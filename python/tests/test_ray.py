"""The pipeline of Ray Data: on broken frames, killed workers and drivers, and an object store."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import objecthood

pytestmark = pytest.mark.filterwarnings("default")  # Ray warns of itself.
ray = pytest.importorskip("ray")
import pyarrow.dataset  # noqa: E402

from objecthood.ray import segment  # noqa: E402

#: What the processes of this cluster know each other by.
MARK = f"OBJECTHOOD_RAY_TEST={uuid.uuid4()}"
FRAMES = 200
#: Every tenth frame is broken.
BROKEN = range(3, FRAMES, 10)


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    name, _, value = MARK.partition("=")
    package = str(Path(__file__).parents[1])
    os.environ |= {name: value, "PYTHONPATH": package, "AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test"}
    ray.init(address="local", num_cpus=2, object_store_memory=1 << 30, include_dashboard=False, log_to_driver=False)
    yield ray.get_runtime_context().gcs_address
    ray.shutdown()


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scene in the layout of BOP."""
    folder = tmp_path_factory.mktemp("archive") / "scene"
    (folder / "depth").mkdir(parents=True)
    scene = objecthood.synthetic("tabletop", 7)
    depth = np.nan_to_num(scene.depth[::2, ::2] * 1e4).astype(np.uint16)
    fx, fy, cx, cy = (part / 2 for part in scene.camera)
    cameras = {str(k): {"cam_K": [fx, 0, cx, 0, fy, cy, 0, 0, 1], "depth_scale": 0.1} for k in range(FRAMES)}
    (folder / "scene_camera.json").write_text(json.dumps(cameras))
    for k in range(FRAMES):
        path = folder / "depth" / f"{k:06d}.png"
        Image.fromarray(depth + np.uint16(3 * k) * (depth > 0)).save(path, compress_level=1)
        if k in BROKEN:
            path.write_bytes(path.read_bytes()[:300])
    return folder


@pytest.fixture(scope="module")
def expected(archive: Path) -> list[tuple[bytes, list[float]] | None]:
    """What one process finds, frame by frame."""
    pipeline = objecthood.Pipeline(threads=1)
    source = objecthood.open(archive)

    def look(k: int) -> tuple[bytes, list[float]]:
        found = pipeline.discover(source[k])
        return found._found.label_png(), found.objectness.tolist()

    return [None if k in BROKEN else look(k) for k in range(FRAMES)]


def rows(out: str) -> list[dict[str, Any]]:
    table = pyarrow.dataset.dataset(f"{out}/frames", format="parquet", partitioning="hive").to_table()
    return sorted(table.to_pylist(), key=lambda row: str(row["frame"]))


def check(out: str, expected: list[tuple[bytes, list[float]] | None]) -> None:
    """Each frame is there once, as one process finds it."""
    found = rows(out)
    assert [int(row["frame"].rpartition("#")[2]) for row in found] == list(range(FRAMES))
    for row, one in zip(found, expected, strict=True):
        if one is None:
            assert row["error"].startswith("FileError: ") and row["objects"] is None
        else:
            labels, objectness = one
            assert row["error"] is None and row["labels_png"] == labels
            assert [thing["objectness"] for thing in row["objects"]] == objectness


def parts(out: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in out.glob("frames/*/part-*.parquet")}


def wait_for_parts(out: Path, count: int, ended: Any) -> None:
    while len(parts(out)) < count:
        assert not ended()
        time.sleep(0.01)


def test_broken_frames_are_rows_and_a_second_run_does_only_what_is_missing(
    cluster: str, archive: Path, expected: list[Any], tmp_path: Path
) -> None:
    out = str(tmp_path / "out")
    summary = segment(archive, out)
    check(out, expected)
    objects = sum(len(one[1]) for one in expected if one)
    assert (summary["frames"], summary["done"], summary["failed"]) == (FRAMES, FRAMES - len(BROKEN), len(BROKEN))
    assert summary["objects"] == objects > 0 and len(summary["failures"]) == len(BROKEN)
    assert json.loads((tmp_path / "out/summary.json").read_text()) == summary

    broken = archive / "depth" / f"{BROKEN[0]:06d}.png"
    content = broken.read_bytes()
    broken.write_bytes((archive / "depth" / f"{BROKEN[0] + 1:06d}.png").read_bytes())
    before = rows(out)
    try:
        assert segment(archive, out)["failed"] == len(BROKEN) - 1
    finally:
        broken.write_bytes(content)
    after = rows(out)
    changed = [k for k in range(FRAMES) if before[k] != after[k]]
    assert changed == [BROKEN[0]] and after[BROKEN[0]]["error"] is None
    # Without failures nothing is written.
    good: list[Any] = [(None, archive / "depth" / f"{k:06d}.png") for k in (0, 1)]
    call: dict[str, Any] = {"camera": (300, 300, 160, 120), "depth_scale": 10000}
    assert segment(good, f"{out}-good", **call)["done"] == 2
    stamps = parts(Path(f"{out}-good"))
    assert segment(good, f"{out}-good", **call)["done"] == 2 and parts(Path(f"{out}-good")) == stamps
    assert segment(good, f"{out}-good", **call, method="paper")["done"] == 2
    assert not stamps.keys() & parts(Path(f"{out}-good")).keys(), "other parameters, other rows"


def workers() -> list[int]:
    """The workers of this cluster."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if b"_Worker" in (process / "cmdline").read_bytes() and MARK.encode() in (process / "environ").read_bytes():
                found.append(int(process.name))
        except OSError:
            continue
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")
def test_a_worker_is_killed(cluster: str, archive: Path, expected: list[Any], tmp_path: Path) -> None:
    out = tmp_path / "out"
    run = threading.Thread(target=segment, args=(archive, str(out)), kwargs={"concurrency": 2})
    run.start()
    wait_for_parts(out, 1, lambda: not run.is_alive())
    found = workers()
    assert found
    os.kill(found[0], signal.SIGKILL)
    run.join()
    check(str(out), expected)


def test_the_driver_is_killed(cluster: str, archive: Path, expected: list[Any], tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "objecthood.ray", str(archive), "--out", str(out), "--workers", "1"]
    environment = os.environ | {"RAY_ADDRESS": cluster}
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    driver = subprocess.Popen(command, env=environment, **quiet)
    wait_for_parts(out, 2, lambda: driver.poll() is not None)
    driver.kill()
    driver.wait()
    again = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert again.returncode == 1, again.stderr
    assert f"{FRAMES - len(BROKEN)} of {FRAMES} frames done, {len(BROKEN)} failed" in again.stdout
    check(str(out), expected)


def test_an_object_store(cluster: str, archive: Path, expected: list[Any]) -> None:
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0)
    server.start()
    try:
        host, port = server.get_host_and_port()
        query = f"endpoint_override={host}:{port}&scheme=http&region=us-east-1&allow_bucket_creation=true"
        filesystem, _ = pyarrow.fs.FileSystem.from_uri(f"s3://frames/?{query}")
        filesystem.create_dir("frames")
        pyarrow.fs.copy_files(str(archive), "frames/scene", destination_filesystem=filesystem, use_threads=False)
        summary = segment(f"s3://frames/scene?{query}", f"s3://frames/out?{query}")
        assert summary["done"] == FRAMES - len(BROKEN)
        table = pyarrow.dataset.dataset("frames/out/frames", filesystem=filesystem, partitioning="hive").to_table()
        labels = {row["frame"].rpartition("#")[2]: row["labels_png"] for row in table.to_pylist()}
        assert labels == {f"{k:07d}": one and one[0] for k, one in enumerate(expected)}
    finally:
        server.stop()


def test_the_command_line_calls_it(cluster: str, archive: Path, tmp_path: Path) -> None:
    program = os.environ.get("OBJECTHOOD_PROGRAM")
    if program is None:
        pytest.skip("OBJECTHOOD_PROGRAM names no program")
    environment = os.environ | {"RAY_ADDRESS": cluster, "OBJECTHOOD_PYTHON": sys.executable}
    (tmp_path / "in/depth").mkdir(parents=True)
    for name in ("scene_camera.json", "depth/000000.png"):
        (tmp_path / "in" / name).write_bytes((archive / name).read_bytes())
    cameras = json.loads((tmp_path / "in/scene_camera.json").read_text())
    (tmp_path / "in/scene_camera.json").write_text(json.dumps({"0": cameras["0"]}))
    command = [program, "batch", "in", "--out", "out", "--method", "paper", "--set", "graph.min_size_px=300", "--workers", "1"]
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0 and "1 of 1 frames done, 0 failed" in run.stdout, run.stderr
    example = Path(__file__).parents[1] / "examples/06_archive.py"
    shown = subprocess.run(
        [sys.executable, str(example), str(tmp_path / "in"), str(tmp_path / "shown")], env=environment, capture_output=True, text=True
    )
    assert shown.returncode == 0 and "1 of 1 frames" in shown.stdout, shown.stderr
    source = objecthood.open(tmp_path / "in")
    params = objecthood.Params(method="paper")
    params.graph.min_size_px = 300
    labels = objecthood.discover(source[0], params=params)._found.label_png()
    assert [row["labels_png"] for row in rows(str(tmp_path / "out"))] == [labels]


def test_the_command_line_takes_pairs(cluster: str, archive: Path, expected: list[Any], tmp_path: Path) -> None:
    program = os.environ.get("OBJECTHOOD_PROGRAM")
    if program is None:
        pytest.skip("OBJECTHOOD_PROGRAM names no program")
    environment = os.environ | {"RAY_ADDRESS": cluster, "OBJECTHOOD_PYTHON": sys.executable}
    camera = ",".join(map(str, objecthood.open(archive)[0].camera))
    command = [program, "batch", "--depth", "depth/00000[0-2].png", "--camera", camera, "--depth-scale", "10000", "--out", str(tmp_path / "out")]
    run = subprocess.run(command, cwd=archive, env=environment, capture_output=True, text=True)
    assert run.returncode == 0 and "3 of 3 frames done" in run.stdout, run.stderr
    assert [row["labels_png"] for row in rows(str(tmp_path / "out"))] == [frame[0] for frame in expected[:3]]


def test_recordings_are_read_in_parts(cluster: str, tmp_path: Path) -> None:
    data = Path(os.environ.get("OBJECTHOOD_DATA", Path(__file__).parents[3] / "shared/data"))
    recordings = [data / "containers" / name for name in ("ros2_mcap/ros2_mcap.mcap", "realsense-softdevice.bag")]
    if not recordings[0].is_file():
        pytest.skip("no real data here, set OBJECTHOOD_DATA to the folder that holds containers")
    summary = segment([str(path) for path in recordings], str(tmp_path / "out"), concurrency=2)
    assert (summary["frames"], summary["failed"]) == (38, 0)
    pipeline = objecthood.Pipeline(threads=1)
    labels = [pipeline.discover(capture)._found.label_png() for path in recordings for capture in objecthood.open(path)]
    assert sorted(row["labels_png"] for row in rows(str(tmp_path / "out"))) == sorted(labels)


def test_what_cannot_be_used_is_said(cluster: str, tmp_path: Path) -> None:
    with pytest.raises(objecthood.FileError, match="there is nothing"):
        segment(tmp_path / "missing", str(tmp_path / "out"))
    with pytest.raises(objecthood.FileError, match="holds no file"):
        segment(tmp_path, str(tmp_path / "out"))
    with pytest.raises(objecthood.InputError, match="no file system"):
        segment("xyz://bucket/frames", str(tmp_path / "out"))
    (tmp_path / "noise.pcd").write_bytes(b"noise")
    summary = segment(tmp_path, str(tmp_path / "out"))
    assert summary["failed"] == 1 and "noise.pcd" in summary["failures"][0]["error"]
