"""Files: what is read, what cannot be, and that the labels are those of the command line."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import objecthood as oh

CLOUD = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 1\n"


def test_a_source_is_a_sequence(tmp_path: Path) -> None:
    for name, text in (("b10.pcd", CLOUD), ("b9.pcd", CLOUD), ("c.pcd", "noise")):
        (tmp_path / name).write_text(text)
    source = oh.open(tmp_path, camera=(525, 525, 0, 0))
    assert len(source) == 3
    assert [source.name(k) for k in range(2)] == ["b9", "b10"]
    assert source.path(1) == str(tmp_path / "b10.pcd") == source[1].path
    assert source[-2].name == "b10" and source.stamp_ns(0) is None
    assert [capture.name for capture in source[:2]] == ["b9", "b10"]
    frames = iter(source)
    assert [next(frames).name, next(frames).name] == ["b9", "b10"]
    with pytest.raises(oh.FileError, match=r"c\.pcd"):
        next(frames)
    for index in (3, -4):
        with pytest.raises(IndexError):
            source[index]


def test_frames_are_selected(tmp_path: Path) -> None:
    for k in range(10):
        (tmp_path / f"{k}.pcd").write_text(CLOUD)

    def names(**selection: str) -> list[str]:
        source = oh.open(tmp_path, camera=(525, 525, 0, 0), frames=selection.get("frames"), time=selection.get("time"))
        return [source.name(k) for k in range(len(source))]

    assert names(frames="2..9:3") == ["2", "5", "8"]
    assert names(frames="4") == ["4"]
    for wrong in ({"frames": "9..2"}, {"frames": "a"}, {"time": "5..1"}):
        with pytest.raises(oh.InputError, match="range"):
            names(**wrong)
    with pytest.raises(oh.FileError, match="no time"):
        oh.open(tmp_path, camera=(525, 525, 0, 0), time="0..1")[0]
    with pytest.raises(oh.InputError, match="list of names"):
        oh.open(tmp_path, topics="/depth")


def test_files_that_cannot_be_read_are_errors_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="cannot be read"):
        oh.open(tmp_path / "missing.pcd")
    with pytest.raises(oh.FileError, match="no point cloud"):
        oh.open(tmp_path)
    with pytest.raises(oh.FileError, match="not a camera file|cannot be read"):
        oh.open(tmp_path, camera=tmp_path / "camera.json")
    with pytest.raises(oh.FileError):
        oh.read_images(tmp_path / "depth.png", camera=(525, 525, 319.5, 239.5), depth_scale=1000)


def decoded(png: Path) -> np.ndarray[tuple[int, int], np.dtype[np.uint16]]:
    image = pytest.importorskip("PIL.Image")
    with image.open(png) as picture:
        return np.asarray(picture).astype(np.uint16)


@pytest.mark.parametrize("method", ["context", "paper"])
def test_labels_are_those_of_the_command_line(method: str, learn: list[Path], program: Path, tmp_path: Path) -> None:
    # All scenes where OBJECTHOOD_ALL_SCENES is set; else every ninth.
    files = learn if "OBJECTHOOD_ALL_SCENES" in os.environ else learn[::9]
    command = [str(program), "segment", *map(str, files), "--method", method, "--out", str(tmp_path), "--write", "labels,json"]
    subprocess.run(command, capture_output=True, check=True)
    pipeline = oh.Pipeline(method=method)
    for path in files:
        found = pipeline.discover(oh.open(path)[0])
        assert np.array_equal(found.labels, decoded(tmp_path / f"{path.stem}.labels.png")), path.name
        assert found.to_json() == (tmp_path / f"{path.stem}.json").read_text(), path.name
        found.save(tmp_path / "mine")
        assert np.array_equal(decoded(tmp_path / "mine" / f"{path.stem}.labels.png"), found.labels)


def test_real_images_are_read_with_their_unit(learn: list[Path]) -> None:
    folder = learn[0].parents[2] / "stills" / "tabletop-clutter"
    if not folder.is_dir():
        pytest.skip(f"skipped: no images in {folder}")
    depth, color = folder / "000000-depth.png", folder / "000000-color.png"
    camera = (612.0, 612.0, 319.5, 239.5)
    with pytest.raises(oh.FileError, match="how many units|unit"):
        oh.read_images(depth, color, camera=camera)
    capture = oh.read_images(depth, color, camera=camera, depth_scale=1000)
    again = oh.discover(capture.depth, camera, color=capture.color)
    assert np.array_equal(oh.discover(capture).labels, again.labels)


def test_a_tracker_keeps_its_numbers(scene: oh.Capture) -> None:
    tracker = oh.Tracker()
    tracks = [tracker.update(scene, stamp=k / 30) for k in range(4)]
    assert tracks[-1].labels.shape == scene.shape
    numbers = [{thing["track"] for thing in tracked.objects} - {None} for tracked in tracks]
    assert numbers[-1] and numbers[-1] == numbers[-2]
    assert set(np.unique(tracks[-1].labels)) - {0} == numbers[-1]
    for stamp in (None, 0.0, float("nan")):
        with pytest.raises(oh.InputError):
            tracker.update(scene, stamp=stamp)
    for pose in (([0, 0], [0, 0, 0, 1]), ([0, 0, 0], [0, 0, 0, 0]), ("x", "y")):
        with pytest.raises(oh.InputError, match="pose"):
            tracker.update(scene, stamp=9.0, pose=pose)
    tracker.skip()
    after = tracker.update(scene, stamp=9.1)
    assert after.data["frame"] == 5, "the frame that was passed over counts"
    assert after.objects[0]["pose"]["rotation_xyzw"] == [0, 0, 0, 1] and after.objects[0]["parts"] == []
    assert isinstance(tracker.finish(), list)
    tracker.reset()
    assert tracker.update(scene, stamp=0.0).data["frame"] == 0
