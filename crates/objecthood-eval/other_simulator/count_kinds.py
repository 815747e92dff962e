#!/usr/bin/env python3
"""Segments the scenes of mujoco_stills.py, and counts by kind of scene and by kind of thing what is found.

    python count_kinds.py objecthood stills/kinect labels/kinect     # program, folder of scenes, folder for labels

The label of a thing is the one that covers most of it. A thing is found if its IoU with its label is 0.75 or more; its pixels without
depth count only where the label covers them. Else it is missed if labels cover less than 0.3 of it. Else it is merged if less than 0.7 of
its label is on it. Else it is split. Things below 80 pixels do not count. A label is a false hypothesis if less than half of it is on
things. `wrong.txt` in the folder for labels has a line for everything that is wrong.
"""

import argparse
import json
import subprocess
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
from PIL import Image

FOUND_IOU, MISSED_COVERAGE, MERGED_PRECISION, FALSE_COVERAGE, LEAST_PX = 0.75, 0.3, 0.7, 0.5, 80
VERDICTS = ("found", "split", "merged", "missed")


def segment(program, scene, folder):
    """The image of labels that the program makes."""
    subprocess.run([program, "segment", scene, "--out", folder, "--write", "labels"], check=True, stdout=subprocess.DEVNULL)
    return np.array(Image.open(next(folder.rglob("*labels*.png")))).astype(int)


def judge(thing, has_depth, labels):
    """The verdict on a thing, its label (0 = none), and their IoU."""
    pixels_of = np.bincount(labels[thing & has_depth], minlength=1)
    pixels_of[0] = 0
    label = int(pixels_of.argmax())
    if label == 0:
        return "missed", 0, 0.0
    own = labels == label
    shared_px = np.sum(thing & own)
    iou = shared_px / np.sum(thing & has_depth | own)
    if iou >= FOUND_IOU:
        return "found", label, iou
    if pixels_of.sum() < MISSED_COVERAGE * thing.sum():
        return "missed", label, iou
    return "merged" if shared_px / own.sum() < MERGED_PRECISION else "split", label, iou


def count(scene, labels, of_scene, of_things):
    """Adds the verdicts of a scene to both counts, and gives a line for everything that is wrong."""
    truth, depth = (np.array(Image.open(scene / name)) for name in ("truth.png", "depth/000000.png"))
    for number, kind in enumerate(json.loads((scene / "kinds.json").read_text()), start=1):
        thing = truth == number
        if thing.sum() < LEAST_PX:
            continue
        verdict, label, iou = judge(thing, depth > 0, labels)
        of_scene[verdict] += 1
        of_things[kind][verdict] += 1
        if verdict != "found":
            yield f"{scene.name} thing {number} {kind}: {verdict}, label {label}, IoU {iou:.2f}, {thing.sum()} px"
    for label in np.unique(labels[labels > 0]):
        own = labels == label
        if np.mean(truth[own] > 0) < FALSE_COVERAGE:
            of_scene["false"] += 1
            yield f"{scene.name} label {label}: false, {own.sum()} px"


def print_table(title, counts, columns):
    print(f"{title:10}", *(f"{column:>7}" for column in columns))
    for kind, verdicts in sorted(counts.items()):
        print(f"{kind:10}", *(f"{verdicts[column]:7}" for column in columns))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", type=Path)
    parser.add_argument("labels", type=Path)
    options = parser.parse_args()
    options.labels.mkdir(parents=True, exist_ok=True)
    of_scenes, of_things, wrong = defaultdict(Counter), defaultdict(Counter), []
    for scene in sorted(path.parent for path in options.scenes.glob("*/kinds.json")):
        labels = segment(options.program, scene, options.labels / scene.name)
        wrong += count(scene, labels, of_scenes[scene.name.rstrip("0123456789")], of_things)
    print_table("scenes", of_scenes, (*VERDICTS, "false"))
    print_table("things", of_things, VERDICTS)
    (options.labels / "wrong.txt").write_text("".join(f"{line}\n" for line in wrong))
