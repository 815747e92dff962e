"""The columns, objects and forms of a discovery."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import objecthood as oh


def test_columns_agree_with_the_labels(found: oh.Discovery) -> None:
    assert len(found) > 2
    assert found.labels.dtype == np.uint16 and found.labels.shape == found.capture.shape
    assert found.ids.tolist() == list(range(1, len(found) + 1))
    assert found.parts.shape == (len(found), len(oh.PARTS))
    for thing in found:
        mask = thing.mask()
        rows, columns = np.nonzero(mask)
        assert mask.sum() == thing.size_px
        assert thing.xyxy.tolist() == [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        points = thing.points()
        assert points.shape == (thing.size_px, 3)
        assert np.array_equal(points[:, 2], found.capture.depth[mask])
        fx, _, cx, _ = found.capture.camera
        assert np.allclose(points[:, 0] / points[:, 2] * fx + cx, columns, atol=1e-3)
        assert np.allclose(points.mean(axis=0), thing.centroid, atol=1e-4)
        assert set(thing.parts) == set(oh.PARTS)
        assert 0 <= thing.objectness <= 1


def test_boxes_are_rotations_around_the_points(found: oh.Discovery) -> None:
    boxes = found.boxes3d
    assert np.allclose(boxes.rotation @ boxes.rotation.transpose(0, 2, 1), np.eye(3), atol=1e-5)
    assert np.allclose(np.linalg.det(boxes.rotation), 1, atol=1e-5)
    for thing in found:
        box = thing.box3d
        inside = np.abs((thing.points() - box.center) @ box.rotation) <= box.size / 2 + 1e-4
        # The box leaves out one per cent at each end of each axis.
        assert inside.mean(axis=0).min() > 0.97
    assert np.allclose(boxes.rotation[:, :, 2], found.up, atol=1e-5), "one axis is up"


def test_objects_are_chosen_by_number_slice_and_mask(found: oh.Discovery) -> None:
    assert found[0].id == 1 and found[-1].id == len(found)
    assert [thing.id for thing in found[1:3]] == [2, 3]
    sure = found.objectness > np.median(found.objectness)
    assert [thing.id for thing in found[sure]] == found.ids[sure].tolist()
    with pytest.raises(IndexError):
        found[len(found)]


def test_the_support_graph_is_that_of_the_scene_file(found: oh.Discovery) -> None:
    nodes = found.support_nodes
    for thing, parents in zip(found.scene["objects"], found.parents, strict=True):
        assert parents == [nodes[node].get("object", 0) or 0 for node in thing["parents"]]
    edges = {(edge.lower, edge.upper) for edge in found.support}
    assert all((parent, thing["node"]) in edges for thing in found.scene["objects"] for parent in thing["parents"])
    assert found.planes.shape[1] == 4 and np.allclose(np.linalg.norm(found.planes[:, :3], axis=1), 1, atol=1e-5)
    assert np.isclose(np.linalg.norm(found.up), 1)
    assert found.structure.max() == len(found.planes)


def test_every_parameter_and_both_methods_reach_the_method(scene: oh.Capture, found: oh.Discovery) -> None:
    params = oh.Params()
    params.objectness.threshold = 1.0
    assert len(oh.discover(scene, params=params)) < len(found)
    paper = oh.discover(scene, method="paper")
    assert paper.scene["method"] == "paper" and paper.params.method == "paper"
    assert set(paper.stages) != set(found.stages)
    turned = oh.discover(scene, gravity=(0, -9.81, 0))
    assert turned.scene["up"]["source"] == "measured" and np.allclose(turned.up, [0, 1, 0])


def test_stages_are_images_of_the_frame(found: oh.Discovery) -> None:
    stages = found.stages
    assert stages["normals"].shape == (*found.capture.shape, 3)
    for name in ("structure", "superpixels", "facets", "shapes", "support"):
        assert stages[name].shape == found.capture.shape and stages[name].min() >= -1
    counts = [len(np.unique(stages[name])) for name in ("superpixels", "facets", "shapes")]
    assert counts == sorted(counts, reverse=True), "each stage joins what the last one found"


def test_an_explanation_names_the_object(found: oh.Discovery) -> None:
    row, column = np.argwhere(found.labels == 1)[found[0].size_px // 2]
    explanation = found.explain(int(column), int(row))
    assert explanation["pixel"] == [column, row]
    assert explanation["parameters_fingerprint"] == found.fingerprint == found.scene["parameters_fingerprint"]
    with pytest.raises(oh.InputError, match="outside the image"):
        found.explain(10_000, 0)
    with pytest.raises(OverflowError):
        found.explain(-1, 0)


def test_files_are_those_of_the_columns(found: oh.Discovery, tmp_path: Path) -> None:
    paths = found.save(tmp_path / "new" / "folder")
    assert [path.name for path in paths] == ["tabletop7.labels.png", "tabletop7.json", "tabletop7.overlay.png"]
    assert json.loads(paths[1].read_text()) == found.scene
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in (paths[0], paths[2]))
    (tmp_path / "taken").write_text("")
    with pytest.raises(OSError):
        found.save(tmp_path / "taken")


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # of pycocotools
def test_coco_run_lengths_are_the_masks(found: oh.Discovery) -> None:
    coco = found.to_coco(image_id=5, first_id=10)
    masks = pytest.importorskip("pycocotools.mask")
    for thing, annotation in zip(found, coco["annotations"], strict=True):
        assert np.array_equal(masks.decode(annotation["segmentation"]), thing.mask())
        assert annotation["label"] == thing.id and annotation["area"] == thing.size_px
        left, top, wide, high = annotation["bbox"]
        assert [left, top, left + wide, top + high] == thing.xyxy.tolist()
    assert [annotation["id"] for annotation in coco["annotations"]] == list(range(10, 10 + len(found)))
    assert json.loads(json.dumps(coco)) == coco


def test_pandas_has_a_row_for_each_object(found: oh.Discovery) -> None:
    pytest.importorskip("pandas")
    table = found.to_pandas()
    assert table["id"].tolist() == found.ids.tolist()
    assert np.allclose(table[["box_size_x_m", "box_size_y_m", "box_size_z_m"]], found.boxes3d.size)


def test_supervision_has_the_same_boxes_and_masks(found: oh.Discovery) -> None:
    pytest.importorskip("supervision")
    detections = found.to_supervision()
    assert np.array_equal(detections.xyxy, found.xyxy)
    assert all(np.array_equal(mask, thing.mask()) for mask, thing in zip(detections.mask, found, strict=True))


def test_open3d_has_the_points_of_each_object_in_its_box(found: oh.Discovery) -> None:
    pytest.importorskip("open3d")
    cloud, boxes = found.to_open3d()
    positions, labels = cloud.point["positions"].numpy(), cloud.point["label"].numpy().ravel()
    for thing, box in zip(found, boxes, strict=True):
        points = positions[labels == thing.id]
        assert np.allclose(points, thing.points(), atol=1e-5)
        sides = (points - box.center) @ box.R
        assert (np.abs(sides) <= box.extent / 2 + 1e-4).mean() > 0.95


def test_a_plot_and_a_notebook_show_the_overlay(found: oh.Discovery) -> None:
    html = found._repr_html_()
    assert html.startswith('<img src="data:image/png;base64,') and html.count("<tr>") == len(found) + 1
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    axes = found.plot()
    assert np.array_equal(axes.images[0].get_array(), found.overlay())
    assert found.plot(ax=axes) is axes


def test_a_missing_package_is_named(found: oh.Discovery, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        found.to_pandas()


def test_a_synthetic_scene_has_a_truth(scene: oh.Capture, found: oh.Discovery) -> None:
    truth = scene.truth
    assert truth is not None
    score = oh.score(found.labels, truth, mosd=True)
    assert score.metrics is not None and score.metrics["oF"] > 0.8
    assert score.correct >= len(score.objects) - 2
    perfect = oh.score(found.labels, found.labels)
    assert perfect.correct == len(found) and perfect.metrics is not None and perfect.metrics["bF"] == 1
    for labels, truths in (
        (found.labels, truth[:10]),
        (found.labels.astype(float), truth),
        (found.labels, truth.astype(np.int64) - 1000),
        (found.labels[0], truth),
    ):
        with pytest.raises(oh.InputError):
            oh.score(labels, truths, mosd=True)
    for family, seed, sensor in (("table", 1, "kinect"), ("single", 1, "eye"), ("single", -1, "kinect")):
        with pytest.raises(oh.InputError):
            oh.synthetic(family, seed, sensor)
