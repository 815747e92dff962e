"""Reads what `objecthood segment` wrote with the programs that are to read it, and compares it with the label images."""

import json
import sys
from importlib.util import find_spec
from pathlib import Path

import jsonschema
import numpy as np
import supervision
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from foxglove_schemas_protobuf import SceneUpdate_pb2
from PIL import Image
from plyfile import PlyData
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO

out = Path(sys.argv[1])
names = sys.argv[2:]
labels = {name: np.array(Image.open(out / f"{name}.labels.png")) for name in names}
scenes = {name: json.loads((out / f"{name}.json").read_text()) for name in names}


def schema():
    published = json.loads((Path(__file__).parents[3] / "docs/scene.schema.json").read_text())
    validator = jsonschema.validators.validator_for(published)
    validator.check_schema(published)
    for scene in scenes.values():
        validator(published).validate(scene)
        assert not validator(published).is_valid({**scene, "objects": 2})


def boxes(scene):
    return [[o["box_px"][k] for k in ("u", "v", "width", "height")] for o in scene["objects"]]


def coco():
    data = COCO(str(out / "instances.coco.json"))
    assert [image["id"] for image in data.loadImgs(data.getImgIds())] == list(range(1, len(names) + 1))
    for number, name in enumerate(names, 1):
        found = data.loadAnns(data.getAnnIds(imgIds=number))
        assert [a["bbox"] for a in found] == boxes(scenes[name])
        for annotation in found:
            mask = data.annToMask(annotation)
            assert (mask == (labels[name] == annotation["label"])).all()
            assert coco_mask.area(annotation["segmentation"]) == annotation["area"]
    results = data.loadRes([{k: a[k] for k in ("image_id", "category_id", "segmentation", "score")} for a in data.anns.values()])
    assert len(results.anns) == len(data.anns)


def detections():
    data = supervision.DetectionDataset.from_coco(str(out), str(out / "instances.coco.json"), force_masks=True)
    assert len(data.annotations) == len(names) and data.classes == ["object"]
    for path, found in data.annotations.items():
        own, scene = labels[Path(path).stem], scenes[Path(path).stem]
        assert (found.mask == [own == o["id"] for o in scene["objects"]]).all()
        assert found.xyxy.tolist() == [[u, v, u + width, v + height] for u, v, width, height in boxes(scene)]


def bop():
    results = json.loads((out / "bop/objecthood_results.json").read_text())
    scene = out / "bop/000000"
    poses, infos, cameras = (json.loads((scene / f"{f}.json").read_text()) for f in ("scene_gt", "scene_gt_info", "scene_camera"))
    for number, name in enumerate(names):
        found = [r for r in results if r["image_id"] == number]
        assert len(found) == len(poses[str(number)]) == len(infos[str(number)]) == len(scenes[name]["objects"])
        assert np.array(cameras[str(number)]["cam_K"]).reshape(3, 3)[0, 0] == scenes[name]["camera"]["fx_px"]
        for k, (result, pose, info) in enumerate(zip(found, poses[str(number)], infos[str(number)])):
            mask = np.array(Image.open(scene / f"mask_visib/{number:06}_{k:06}.png"))
            assert (mask == 255 * (labels[name] == pose["obj_id"])).all()
            assert (coco_mask.decode(result["segmentation"]) == mask // 255).all()
            assert result["bbox"] == info["bbox_visib"] and info["px_count_visib"] == (mask > 0).sum()
            rotation = np.array(pose["cam_R_m2c"]).reshape(3, 3)
            assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) and np.linalg.det(rotation) > 0
            x, y, z, w = scenes[name]["objects"][k]["box_m"]["rotation_xyzw"]
            assert np.allclose(rotation[:, 2], [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], atol=1e-5)


def npz():
    for name in names:
        data, scene = np.load(out / f"{name}.labels.npz"), scenes[name]
        assert (data["segmap"] == labels[name]).all() and data["rgb"].shape == (*labels[name].shape, 3)
        assert data["depth"].dtype == np.float32 and np.isfinite(data["depth"]).any()
        assert data["K"][0, 2] == scene["camera"]["cx_px"]
        assert np.allclose(data["objectness"], [o["objectness"] for o in scene["objects"]])
        assert data["box_px"].tolist() == boxes(scene)
        assert len(data["parents"]) == sum(len(o["parents"]) for o in scene["objects"])


def ply():
    for name in names:
        points = PlyData.read(out / f"{name}.labels.ply")["vertex"]
        depth = np.load(out / f"{name}.labels.npz")["depth"]
        assert len(points) == np.isfinite(depth).sum()
        assert (labels[name].ravel()[points["pixel"]] == points["label"]).all()
        assert (depth.ravel()[points["pixel"]] == points["z"]).all()
        camera = scenes[name]["camera"]
        u = points["x"] / points["z"] * camera["fx_px"] + camera["cx_px"]
        assert np.abs(u - points["pixel"] % depth.shape[1]).max() < 1e-3
        for o in scenes[name]["objects"]:
            own = PlyData.read(out / f"{name}.object{o['id']}.labels.ply")["vertex"]
            assert (own["label"] == o["id"]).all() and len(own) == (points["label"] == o["id"]).sum()


def open3d():
    if find_spec("open3d") is None:
        print("skipped: Open3D, 400 MB to fetch, is not installed")
        return
    from open3d import io, t

    for name in names:
        path = str(out / f"{name}.labels.ply")
        points, cloud, tensor = PlyData.read(path)["vertex"], io.read_point_cloud(path), t.io.read_point_cloud(path)
        xyz, rgb = (np.stack([points[k] for k in keys], axis=1) for keys in (("x", "y", "z"), ("red", "green", "blue")))
        assert (np.asarray(cloud.points) == xyz).all() and np.allclose(np.asarray(cloud.colors), rgb / 255)
        assert (tensor.point.positions.numpy() == xyz).all()
        for key in ("label", "pixel"):
            assert (tensor.point[key].numpy().ravel() == points[key]).all()


def fields(message):
    return [f.name for f in sorted(message.DESCRIPTOR.fields, key=lambda f: f.number)]


def recording():
    with open(out / "objects.labels.mcap", "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        messages = [(channel.topic, message, ros) for _, channel, message, ros in reader.iter_decoded_messages()]
    of = lambda topic: [(message, ros) for t, message, ros in messages if t == topic]
    images, updates, infos = of("/objecthood/labels"), of("/objecthood/objects"), of("/objecthood/camera_info")
    assert len(images) == len(updates) == len(infos) == len(names)
    for number, name in enumerate(names):
        message, image = images[number]
        assert message.log_time == image.header.stamp.sec * 10**9 + image.header.stamp.nanosec
        assert image.encoding == "16UC1" and image.step == 2 * image.width
        assert (np.frombuffer(image.data, "<u2").reshape(image.height, image.width) == labels[name]).all()
        assert infos[number][1].k[0] == scenes[name]["camera"]["fx_px"] and infos[number][1].width == image.width
        update = updates[number][1]
        assert [e.id for e in update.entities] == [str(o["id"]) for o in scenes[name]["objects"]]
        for entity, o in zip(update.entities, scenes[name]["objects"]):
            size = entity.cubes[0].size
            assert np.allclose([size.x, size.y, size.z], o["box_m"]["extents_m"])
            assert entity.metadata[0].key == "objectness"
        # The fields are those of Foxglove's own package, in their order.
        entity = update.entities[0]
        theirs = SceneUpdate_pb2.SceneUpdate()
        assert list(update.__slots__) == fields(theirs)
        assert list(entity.__slots__) == fields(theirs.entities.add())
        assert list(entity.cubes[0].__slots__) == fields(theirs.entities[0].cubes.add())
        assert list(entity.texts[0].__slots__) == fields(theirs.entities[0].texts.add())
        assert list(update.deletions[0].__slots__) == fields(theirs.deletions.add())


schema(), coco(), detections(), bop(), npz(), ply(), open3d(), recording()
print("read back", len(names))
