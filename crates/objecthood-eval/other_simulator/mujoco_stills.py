#!/usr/bin/env python3
"""Still scenes with truth by MuJoCo, a simulator that is not ours: what leans on the looks of our own synthetic scenes shows here.

    pip install mujoco numpy pillow scipy                       # renders by EGL; libegl1 and libgl1-mesa-dri are enough
    python mujoco_stills.py table kinect 0 10 stills/kinect     # ten scenes, seeds 0 to 9
    python count_kinds.py objecthood stills/kinect labels/kinect
    objecthood eval stills/kinect

Kinds are table, pile, shelf, bin, floor, vessels, flush and room. Sensors are kinect, stereo and tof. The same kind, seed and sensor make the same
scene. The things come to rest before the image is taken. A scene is a folder in the layout of BOP. Its `truth.png` has the number of the
thing at each pixel, from 1 on. Its `kinds.json` has the kinds of the things in that order. Room, table, shelf and bin are no things: they
are 0. `count_kinds.py` counts what is found, by kind, and what is false. Lengths are metres, angles degrees.
"""

import argparse
import json
import tempfile
from pathlib import Path

from mujoco_clips import render  # first: it says how MuJoCo renders
import mujoco
import numpy as np
from PIL import Image
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import gaussian_filter, maximum_filter, minimum_filter

KINDS = ("table", "pile", "shelf", "bin", "floor", "vessels", "flush", "room")
DEPTH_PER_M, LEAST_MASK_PX, TEXTURE_PX = 4000, 20, 256
STEP_S, SETTLE_STEPS, BRAKE_STEPS, BRAKE = 0.002, 2500, 10, 0.9
TABLE_M, BOARDS_M, SHELF_Y_M = 0.74, (0.35, 0.75, 1.15), 0.3
PATTERNS = {"flat": 0.4, "print": 0.2, "wood": 0.1, "noise": 0.1, "label": 0.12, "checker": 0.08}
# A kind that is here twice comes twice as often.
COMMON = """box box book can can ball fruit bottle bottle bowl cup cup plate vase hammer driver spatula banana teddy phone pen brick
    jar spray carton carton""".split()
STACKED, ON_SHELF = "box can ball fruit phone brick pen".split(), "box can bottle cup jar carton spray ball vase book".split()
VESSELS, CONTENTS = "bowl bowl plate cup".split(), "fruit ball brick pen can".split()
TWO_PAINTS = ("hammer", "driver", "spatula", "jar", "spray")
# Form, and the least and the most size. The last number is the height of the middle.
SIMPLE = {
    "box": ("box", [0.025, 0.025, 0.015], [0.1, 0.07, 0.11]),
    "book": ("box", [0.06, 0.08, 0.006], [0.1, 0.13, 0.02]),
    "can": ("cylinder", [0.025, 0.04], [0.045, 0.09]),
    "ball": ("sphere", [0.025], [0.06]),
}
# The least and the most radius and half height, and the outside from foot to rim in shares of them.
HOLLOW = {
    "bowl": ([0.06, 0.02], [0.1, 0.04], [(0.35, -1), (0.7, -0.6), (0.93, 0.2), (1, 1)]),
    "cup": ([0.035, 0.04], [0.045, 0.06], [(0.8, -1), (0.95, 0), (1, 1)]),
    "plate": ([0.09, 0.008], [0.13, 0.013], [(0.35, -1), (0.7, -0.6), (0.93, 0.2), (1, 1)]),
    "vase": ([0.04, 0.08], [0.06, 0.13], [(0.5, -1), (1, -0.3), (0.6, 0.5), (0.75, 1)]),
}
# The mesh of a bottle or a hollow thing is seen but not hit. Solids without looks are hit in its place, but not seen.
UNHIT, UNSEEN = 'contype="0" conaffinity="0" mass="0"', 'group="3" rgba="0 0 0 0"'


def numbers(values, digits=5):
    return " ".join(f"{value:.{digits}f}" for value in values)


def geom(kind, size, at=(0, 0, 0), euler=(0, 0, 0), looks=UNSEEN):
    return f'<geom type="{kind}" size="{numbers(size)}" pos="{numbers(at)}" euler="{numbers(euler)}" {looks} density="500"/>'


def solid(kind, rng):
    """A shape of solid parts (form, size, place, angles), and the height of its middle when it stands."""
    middle, lying = (0, 0, 0), (0, 90, 0)
    if kind in SIMPLE:
        form, least, most = SIMPLE[kind]
        size = rng.uniform(least, most)
        return [(form, size)], size[-1]
    if kind == "fruit":
        radius, length, height = rng.uniform([0.025, 1, 0.85], [0.045, 1.6, 1.1])
        return [("ellipsoid", [radius * length, radius, radius * height])], radius * height
    if kind == "pen":
        return [("capsule", [0.005, 0.065], middle, lying)], 0.005
    if kind == "phone":
        return [("box", [0.036, 0.075, 0.004])], 0.004
    if kind == "hammer":
        half = rng.uniform(0.08, 0.12)
        return [("capsule", [0.012, half], middle, lying), ("box", [0.018, 0.05, 0.018], (half, 0, 0.006))], 0.012
    if kind == "driver":
        half = rng.uniform(0.04, 0.055)
        return [("capsule", [0.014, half], middle, lying), ("cylinder", [0.004, 0.06], (half + 0.06, 0, 0), lying)], 0.014
    if kind == "spatula":
        half = rng.uniform(0.07, 0.1)
        return [("capsule", [0.008, half], middle, lying), ("box", [0.045, 0.03, 0.003], (half + 0.045, 0, 0))], 0.008
    if kind == "jar":
        radius, half = rng.uniform([0.03, 0.035], [0.045, 0.06])
        return [("cylinder", [radius, half]), ("cylinder", [radius * 0.9, 0.01], (0, 0, half + 0.01))], half
    if kind == "spray":
        radius, half = rng.uniform([0.025, 0.07], [0.035, 0.1])
        neck, head = ("cylinder", [0.012, 0.015], (0, 0, half + 0.015)), ("box", [0.035, 0.012, 0.014], (0.015, 0, half + 0.04))
        return [("cylinder", [radius, half]), neck, head], half
    if kind == "brick":
        half, height, knob = 0.032 * rng.integers(1, 3), 0.019, 0.016
        places = [(x, y, height + 0.004) for x in np.arange(-half + knob, half, 2 * knob) for y in (-knob, knob)]
        return [("box", [half, 2 * knob, height])] + [("cylinder", [0.009, 0.004], at) for at in places], height
    if kind == "banana":
        angles, thick, bend = np.arange(-55, 56, 11), 0.017, 0.09
        places = [(bend * np.cos(angle) - 0.07, bend * np.sin(angle), 0) for angle in np.radians(angles)]
        sizes = [[thick * (1 - 0.3 * abs(angle) / 55), 0.012] for angle in angles]
        return [("capsule", size, at, (90, 0, angle)) for size, at, angle in zip(sizes, places, angles)], thick
    return teddy(rng.uniform(0.03, 0.045))


def teddy(size):
    parts = [("ellipsoid", [1, 0.85, 1.2], (0, 0, 0)), ("sphere", [0.75], (0, 0, 1.7))]
    for side in (-1, 1):
        parts.append(("sphere", [0.28], (0, side * 0.6, 2.3)))
        parts.append(("capsule", [0.3, 0.4], (0.3, side * 0.95, 0.5), (60 * side, 0, 0)))
        parts.append(("capsule", [0.33, 0.45], (0.9, side * 0.5, -0.85), (0, 90, 0)))
    return [(form, np.multiply(size, shares), np.multiply(size, at), *euler) for form, shares, at, *euler in parts], size * 1.2


def turned(profile, sides=40):
    """The mesh of a profile of (radius, height) that turns around the vertical axis: vertices and triangles."""
    angles, triangles = np.arange(sides) / sides * 2 * np.pi, []
    for ring in range(0, (len(profile) - 1) * sides, sides):
        for side in range(sides):
            here, beside = ring + side, ring + (side + 1) % sides
            triangles += [(here, beside, beside + sides), (here, beside + sides, here + sides)]
    return [(radius * np.cos(angle), radius * np.sin(angle), height) for radius, height in profile for angle in angles], triangles


def carton(rng):
    """A box with a gable: its mesh, and the height of its middle."""
    side, half = rng.uniform([0.03, 0.06], [0.045, 0.1])
    vertices = [(x * side, y * side, z * half) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    triangles = [(0, 2, 1), (0, 3, 2), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6)]
    triangles += [(3, 0, 4), (3, 4, 7), (4, 5, 9), (4, 9, 8), (6, 7, 8), (6, 8, 9), (5, 6, 9), (7, 4, 8)]
    return (vertices + [(x * side, 0, half + side * 0.8) for x in (-1, 1)], triangles), half


def bottle(rng):
    """Mesh, solids, and the height of the middle."""
    radius, half, neck = rng.uniform([0.025, 0.07, 0.01], [0.045, 0.12, 0.015])
    body = [(0, -half), (radius * 0.9, -half), (radius, -half + 0.006), (radius, half * 0.25), (radius * 0.85, half * 0.4)]
    top = [(neck * 1.3, half * 0.62), (neck, half * 0.75), (neck, half * 0.92), (neck * 1.25, half * 0.92), (neck * 1.25, half), (0, half)]
    solids = geom("cylinder", [radius, half * 0.65], (0, 0, -half * 0.35)) + geom("cylinder", [neck, half * 0.3], (0, 0, half * 0.7))
    return turned(body + top), solids, half


def hollow(kind, rng, looks):
    """Mesh, solids and the height of the middle. The solids are the bottom, staves, and the handle of a cup, which is seen too."""
    # The sizes of all four kinds are drawn, and one is taken.
    sizes = {name: rng.uniform(least, most) for name, (least, most, _) in HOLLOW.items()}
    (radius, half), wall = sizes[kind], 0.004
    points = np.multiply(HOLLOW[kind][2], [radius, half])
    outside = PchipInterpolator(range(len(points)), points)(np.linspace(0, len(points) - 1, 8 * (len(points) - 1) + 1))
    inside = [(at - wall, max(height, -half + wall)) for at, height in outside[::-1]]
    solids, last = geom("cylinder", [outside[0][0], wall / 2], (0, 0, -half + wall / 2)), len(outside) - 1
    for angle in np.arange(16) * 22.5:
        for point in range(0, last, len(outside) // 5):
            at, height = outside[min(point + 2, last)]
            place = (at - wall / 2) * np.cos(np.radians(angle)), (at - wall / 2) * np.sin(np.radians(angle)), height
            solids += geom("box", [wall / 2, at * 0.2, half / 5], place, (0, 0, angle))
    if kind == "cup" and rng.random() < 0.8:
        for angle in np.arange(-80, 81, 20):
            place = radius + 0.018 * np.cos(np.radians(angle)), 0, 0.026 * np.sin(np.radians(angle))
            solids += geom("capsule", [0.005, 0.006], place, (0, -angle, 0), looks)
    return turned([(0, -half), *outside, *inside, (0, -half + wall)]), solids, half


def texture(pattern, colors, rng):
    rows, columns = np.mgrid[0:TEXTURE_PX, 0:TEXTURE_PX]
    picture = np.ones((*rows.shape, 3)) * colors[0]
    if pattern == "wood":
        picture *= (1 + 0.18 * np.sin(columns / 7 + 80 * gaussian_filter(rng.normal(size=rows.shape), 20)))[..., None]
    if pattern == "noise":
        picture *= (1 + 2.4 * gaussian_filter(rng.normal(size=rows.shape), 3))[..., None]
    if pattern == "checker":
        picture[(rows // 32 + columns // 32) % 2 == 1] = colors[1]
    if pattern == "label":
        picture[80:170], picture[100:150, 60:200] = colors[1], colors[2]
    if pattern == "print":
        for _ in range(rng.integers(4, 14)):
            (y, x), (height, width) = rng.integers(0, TEXTURE_PX - 30, 2), rng.integers(8, 90, 2)
            picture[y : y + height, x : x + width] = colors[rng.integers(1, 4)]
        for _ in range(rng.integers(3, 9)):
            y, x = rng.integers(0, TEXTURE_PX - 8), rng.integers(0, TEXTURE_PX - 90)
            for letter in range(rng.integers(4, 14)):
                if rng.random() < 0.75:
                    picture[y : y + 6, x + 6 * letter : x + 6 * letter + 4] = colors[3]
    return (picture.clip(0, 1) * 255).astype(np.uint8)


class Scene:
    """What stands where, as text for MuJoCo. The folder holds its textures and meshes until the model is made."""

    def __init__(self, kind, seed, folder):
        self.rng, self.folder = np.random.default_rng([seed, sum(map(ord, kind))]), folder
        self.assets, self.room, self.things, self.kinds = [], "", "", []
        self.ground_m = TABLE_M if kind in ("table", "pile", "vessels", "flush") else 0
        rng = self.rng
        self.build("plane", [4, 4, 0.1], [0, 0, 0], self.paint())
        if rng.random() < 0.7:
            self.build("box", [4, 0.05, 1.5], [0, rng.uniform(0.8, 1.8), 1.5], self.paint())
        if rng.random() < 0.4:
            self.build("box", [0.05, 4, 1.5], [rng.choice([-1, 1]) * rng.uniform(1, 2), 0, 1.5], self.paint())
        self.azimuth, self.elevation = np.radians(rng.uniform([-120, 25], [-60, 60]))
        self.distance_m, self.target_m = rng.uniform(0.8, 1.4), [0, 0, self.ground_m + 0.05]
        if self.ground_m:
            self.build_table()
        getattr(self, f"fill_{kind}")()

    def paint(self):
        """The looks of a thing: one colour, or a texture."""
        pattern, colors = self.rng.choice(list(PATTERNS), p=list(PATTERNS.values())), self.rng.uniform(0.08, 0.95, (4, 3))
        if pattern == "flat":
            return f'rgba="{numbers(colors[0])} 1"'
        name = f"asset{len(self.assets)}"
        Image.fromarray(texture(pattern, colors, self.rng)).save(path := self.folder / f"{name}.png")
        self.assets.append(f'<texture name="{name}" type="cube" file="{path}"/><material name="{name}" texture="{name}"/>')
        return f'material="{name}"'

    def mesh(self, vertices, triangles, looks):
        name = f"asset{len(self.assets)}"
        lines = [f"v {numbers(vertex)}\n" for vertex in vertices] + [f"f {numbers(np.add(corners, 1), 0)}\n" for corners in triangles]
        (path := self.folder / f"{name}.obj").write_text("".join(lines))
        self.assets.append(f'<mesh name="{name}" file="{path}" inertia="shell"/>')
        return f'<geom type="mesh" mesh="{name}" {looks}/>'

    def shape(self, kind):
        """The geoms of a new thing, and the height of its middle when it stands."""
        looks = self.paint()
        other_looks = self.paint() if self.rng.random() < 0.5 else looks
        if kind == "carton":
            mesh, height_m = carton(self.rng)
            return self.mesh(*mesh, f'{looks} density="500"'), height_m
        if kind == "bottle" or kind in HOLLOW:
            mesh, solids, height_m = bottle(self.rng) if kind == "bottle" else hollow(kind, self.rng, looks)
            return self.mesh(*mesh, f"{looks} {UNHIT}") + solids, height_m
        parts, height_m = solid(kind, self.rng)
        looks_of_others = other_looks if kind in TWO_PAINTS else looks
        return geom(*parts[0], looks=looks) + "".join(geom(*part, looks=looks_of_others) for part in parts[1:]), height_m

    def put(self, kinds, x, y, z, tilt=(0, 0)):
        """Puts a thing of one of the kinds there, its lowest point a little above `z`."""
        kind = self.rng.choice(kinds)
        geoms, height_m = self.shape(kind)
        at, euler = numbers([x, y, z + height_m + 0.003], 4), numbers([*tilt, self.rng.uniform(0, 360)], 1)
        self.things += f'<body pos="{at}" euler="{euler}"><freejoint/>{geoms}</body>'
        self.kinds.append(kind)

    def free_place(self, spread_m, depth_share, gap_m, places):
        """A place that is far enough from the others, if one is found."""
        for _ in range(300):
            place = self.rng.uniform(-spread_m, spread_m, 2) * [1, depth_share]
            if all(np.hypot(*(place - other)) > gap_m for other in places):
                break
        places.append(place)
        return place

    def build(self, kind, size, at, looks, digits=3):
        """Adds what does not move."""
        self.room += f'<geom type="{kind}" size="{numbers(size, 3)}" pos="{numbers(at, digits)}" {looks}/>'

    def build_table(self):
        looks, half_m, leg_m = self.paint(), self.rng.uniform([0.45, 0.35], [0.7, 0.5]), self.ground_m / 2 - 0.02
        if self.rng.random() < 0.25:
            self.build("cylinder", [half_m[0], 0.02], [0, 0, self.ground_m - 0.02], looks)
            self.build("cylinder", [0.05, leg_m - 0.01], [0, 0, leg_m - 0.01], looks)
            return
        self.build("box", [*half_m, 0.02], [0, 0, self.ground_m - 0.02], looks)
        for corner in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            self.build("box", [0.025, 0.025, leg_m], [*(corner * (half_m - 0.05)), leg_m], looks)

    def fill_table(self):
        """Things side by side, and a few that fall onto them."""
        spread_m, places = 0.33 if self.ground_m else 0.45, []
        for k in range(self.rng.integers(6, 13)):
            self.put(COMMON, *self.free_place(spread_m, 0.75, 0.1, places), self.ground_m + 0.001 * k)
        for _ in range(self.rng.integers(0, 3)):
            self.put(STACKED, *self.rng.uniform(-0.25, 0.25, 2), self.ground_m + 0.3)

    fill_floor = fill_table

    def fill_pile(self):
        for k in range(self.rng.integers(10, 18)):
            place = self.rng.uniform(-0.14, 0.14, 2)
            self.put(COMMON, *place, self.ground_m + 0.02 + 0.09 * k, tilt=self.rng.uniform(-40, 40, 2))

    def fill_vessels(self):
        """Vessels, and what falls into them."""
        places = []
        for _ in range(self.rng.integers(2, 5)):
            place = self.free_place(0.3, 0.7, 0.24, places)
            self.put(VESSELS, *place, self.ground_m)
            for k in range(self.rng.integers(1, 4)):
                self.put(CONTENTS, *(place + self.rng.uniform(-0.02, 0.02, 2)), self.ground_m + 0.1 + 0.1 * k)

    def fill_flush(self):
        """Groups of two or three boxes, side by side or on each other, whose other sides lie in one plane."""
        places, gap_m = [], 0.0003
        for _ in range(3):
            place, turn_deg = self.free_place(0.28, 0.7, 0.26, places), self.rng.uniform(0, 360)
            size_m, is_stack, along_m = self.rng.uniform([0.05, 0.04, 0.04], [0.12, 0.1, 0.12]), self.rng.random() < 0.4, 0
            axis = np.array([0, 0, 1]) if is_stack else np.array([np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg)), 0])
            for _ in range(self.rng.integers(2, 4)):
                if not is_stack:
                    size_m[0] = self.rng.uniform(0.03, 0.09)
                length_m = size_m[2 if is_stack else 0]
                foot = np.array([*place, self.ground_m + gap_m]) + (0 if is_stack else size_m[2] / 2) * np.array([0, 0, 1])
                at, euler = numbers(foot + (along_m + length_m / 2) * axis), numbers([0, 0, turn_deg], 2)
                self.things += f'<body pos="{at}" euler="{euler}"><freejoint/>{geom("box", size_m / 2, looks=self.paint())}</body>'
                self.kinds.append("box")
                along_m += length_m + gap_m

    def fill_shelf(self):
        rng, half_m, looks, deep_m = self.rng, self.rng.uniform(0.4, 0.5), self.paint(), 0.16
        for board_m in BOARDS_M:
            # All digits: another last bit makes things come to rest elsewhere.
            self.build("box", [half_m, deep_m, 0.01], [0, SHELF_Y_M, board_m - 0.01], looks, digits=17)
        for x_m in (-half_m, half_m):
            self.build("box", [0.01, deep_m, 0.8], [x_m, SHELF_Y_M, 0.8], looks)
        if rng.random() < 0.7:
            self.build("box", [half_m, 0.005, 0.8], [0, SHELF_Y_M + deep_m, 0.8], looks)
        for board_m in BOARDS_M:
            for x_m in np.arange(-half_m + 0.1, half_m - 0.08, 0.17):
                if rng.random() < 0.8:
                    self.put(ON_SHELF, x_m + rng.uniform(-0.02, 0.02), SHELF_Y_M + rng.uniform(-0.06, 0.03), board_m)
        self.target_m, self.distance_m = [0, SHELF_Y_M - 0.1, 0.8], rng.uniform(1.2, 1.5)
        self.elevation, self.azimuth = np.radians(rng.uniform([3, -110], [25, -70]))

    def fill_bin(self):
        """An open box with thin walls, and what falls into it."""
        half_m, thin_m, rng = self.rng.uniform([0.2, 0.15, 0.08], [0.3, 0.22, 0.14]) / [1, 1, 2], 0.004, self.rng
        looks = self.paint()
        self.build("box", [*half_m[:2], thin_m], [0, 0, thin_m], looks)
        for x, y in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            size = [thin_m if x else half_m[0], thin_m if y else half_m[1], half_m[2]]
            self.build("box", size, half_m * [x, y, 1], looks)
        for k in range(rng.integers(6, 14)):
            place = rng.uniform(-half_m[:2] + [0.08, 0.06], half_m[:2] - [0.08, 0.06])
            self.put(COMMON, *place, 0.03 + 0.1 * k, tilt=rng.uniform(-30, 30, 2))
        self.elevation, self.distance_m = np.radians(rng.uniform(50, 80)), rng.uniform(0.7, 1)

    def fill_room(self):
        """A desk with things, a chair, a cupboard or a seat, often a rug, a lamp or a person, and things on the floor between them."""
        rng, half_m, looks = self.rng, self.rng.uniform([0.5, 0.3], [0.7, 0.4]), self.paint()
        self.build("box", [*half_m, 0.015], [0, 0, 0.705], looks)
        for corner in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            self.build("box", [0.02, 0.02, 0.345], [*(corner * (half_m - 0.04)), 0.345], looks)
        places = []
        for k in range(rng.integers(4, 9)):
            self.put(COMMON, *self.free_place(half_m[0] - 0.1, (half_m[1] - 0.08) / (half_m[0] - 0.1), 0.12, places), 0.72 + 0.001 * k)
        self.build_chair(rng.uniform([-0.4, -0.9], [0.4, -0.5]), self.paint())
        side = rng.choice([-1, 1])
        if rng.random() < 0.5:
            self.build_cupboard(side * rng.uniform(1.1, 1.5), self.paint())
        else:
            self.build_seat(side * rng.uniform(1.2, 1.6), self.paint())
        if rng.random() < 0.5:
            self.build("box", [*rng.uniform(0.4, 0.8, 2), 0.004], [*rng.uniform(-0.5, 0.5, 2), 0.004], self.paint())
        if rng.random() < 0.4:
            self.build_lamp(-side * rng.uniform(0.8, 1.2), self.paint())
        if rng.random() < 0.3:
            self.build_person(rng.uniform([-1.2, 0.3], [1.2, 0.8]))
        for x in rng.uniform(-1, 1, rng.integers(1, 4)):
            self.put("box box ball carton bottle teddy brick vase".split(), x, rng.uniform(-1.1, -0.95), 0.005)
        self.target_m, self.distance_m = [*rng.uniform([-0.3, -0.3], [0.3, 0.1]), 0.5], rng.uniform(1.6, 2.4)
        self.elevation, self.azimuth = np.radians(rng.uniform([12, -130], [35, -50]))

    def build_chair(self, place, looks):
        for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            self.build("cylinder", [0.016, 0.22], [place[0] + 0.18 * x, place[1] + 0.18 * y, 0.22], looks)
        self.build("box", [0.21, 0.21, 0.015], [*place, 0.455], looks)
        for x in (-0.18, 0.18):
            self.build("cylinder", [0.014, 0.2], [place[0] + x, place[1] - 0.19, 0.67], looks)
        self.build("box", [0.2, 0.01, 0.09], [place[0], place[1] - 0.19, 0.8], looks)

    def build_cupboard(self, x_m, looks):
        """A body with drawers that stand out a little, each with a knob; a thing may stand on it."""
        half_m = self.rng.uniform([0.2, 0.2, 0.3], [0.35, 0.25, 0.6])
        self.build("box", half_m, [x_m, 0.2, half_m[2]], looks)
        for k in range(3):
            height_m = half_m[2] * (2 * k + 1) / 3
            self.build("box", [half_m[0] - 0.02, 0.008, half_m[2] / 3 - 0.012], [x_m, 0.2 - half_m[1], height_m], looks)
            self.build("sphere", [0.014], [x_m, 0.185 - half_m[1], height_m], 'rgba="0.7 0.7 0.7 1"')
        if half_m[2] < 0.5:
            self.put(ON_SHELF, x_m, 0.2, 2 * half_m[2])

    def build_seat(self, x_m, looks):
        """An armchair with a cushion; a thing may lie on it."""
        self.build("box", [0.38, 0.35, 0.19], [x_m, 0.2, 0.19], looks)
        self.build("box", [0.38, 0.09, 0.25], [x_m, 0.46, 0.6], looks)
        for x in (-0.34, 0.34):
            self.build("box", [0.07, 0.35, 0.12], [x_m + x, 0.2, 0.5], looks)
        if self.rng.random() < 0.6:
            self.put(STACKED, x_m, 0.05, 0.385)

    def build_lamp(self, x_m, looks):
        self.build("cylinder", [0.14, 0.01], [x_m, 0.3, 0.01], looks)
        self.build("cylinder", [0.013, 0.7], [x_m, 0.3, 0.71], looks)
        self.build("cylinder", [0.15, 0.12], [x_m, 0.3, 1.5], looks)

    def build_person(self, place):
        trousers, shirt, skin = self.paint(), self.paint(), f'rgba="{numbers(self.rng.uniform([0.4, 0.3, 0.2], [0.9, 0.7, 0.6]))} 1"'
        for x in (-0.1, 0.1):
            self.build("capsule", [0.075, 0.35], [place[0] + x, place[1], 0.43], trousers)
            self.build("capsule", [0.045, 0.28], [place[0] + 2.5 * x, place[1], 1.05], shirt)
            self.build("sphere", [0.05], [place[0] + 2.5 * x, place[1], 0.72], skin)
        self.build("ellipsoid", [0.2, 0.13, 0.34], [*place, 1.1], shirt)
        self.build("ellipsoid", [0.09, 0.1, 0.13], [*place, 1.58], skin)

    def describe(self, field_deg):
        return f"""<mujoco><option timestep="{STEP_S}"/>
            <visual><global offwidth="1280" offheight="720" fovy="{field_deg}"/><map znear="0.02" zfar="20"/></visual>
            <asset>{"".join(self.assets)}</asset>
            <worldbody>
                <light pos="{self.rng.uniform(-1, 1):.2f} -1 3" dir="0 .2 -1" diffuse=".6 .6 .6"/>
                <light pos="1 1 3" dir="-.2 -.2 -1" diffuse=".35 .35 .3" castshadow="false"/>
                {self.room}{self.things}<camera name="camera"/>
            </worldbody></mujoco>"""

    def settle(self, field_deg):
        """The model, and the data once everything has fallen and the camera stands."""
        model = mujoco.MjModel.from_xml_string(self.describe(field_deg))
        data = mujoco.MjData(model)
        for step in range(SETTLE_STEPS):
            mujoco.mj_step(model, data)
            if step % BRAKE_STEPS == 0:
                data.qvel[:] *= BRAKE
        level = np.cos(self.elevation)
        back = np.array([np.cos(self.azimuth) * level, np.sin(self.azimuth) * level, np.sin(self.elevation)])
        right = np.cross([0, 0, 1], back)
        right /= np.linalg.norm(right)
        roll, quaternion = np.radians(self.rng.uniform(-6, 6)), np.zeros(4)
        rolled = np.array([[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
        mujoco.mju_mat2Quat(quaternion, (np.stack([right, np.cross(back, right), back], axis=1) @ rolled).flatten())
        model.cam_pos[0], model.cam_quat[0] = self.target_m + self.distance_m * back, quaternion
        mujoco.mj_forward(model, data)
        return model, data


def smooth_noise(rng, shape, reach_px):
    """Noise that neighbours share, of standard deviation 1."""
    noise = gaussian_filter(rng.normal(size=shape), reach_px)
    return noise / noise.std()


def hidden(disparity_px):
    """What a nearer thing hides from the projector or the second camera, to the right."""
    lit_px = np.arange(disparity_px.shape[1]) - disparity_px
    nearest_px = np.minimum.accumulate(lit_px[:, ::-1], axis=1)[:, ::-1]
    return np.pad(lit_px[:, :-1] > nearest_px[:, 1:] + 1, [(0, 0), (0, 1)])


def kinect(depth_m, focal_px, _, rng):
    """Disparity in eighths of a pixel, noise that neighbours share, shaking edges, shadows; 0 = none."""
    scale = focal_px * 0.075
    shaken = [(at + rng.normal(size=at.shape) * 0.5).round().astype(int) for at in np.indices(depth_m.shape)]
    seen_m = depth_m[tuple(np.clip(at, 0, size - 1) for at, size in zip(shaken, depth_m.shape))]
    disparity_px = scale / seen_m + smooth_noise(rng, depth_m.shape, 1.2) * 0.055
    measured_m = scale / np.maximum(np.round(disparity_px * 8) / 8, 0.125)
    return np.where(hidden(scale / depth_m) | (measured_m > 8), 0, measured_m)


def stereo(depth_m, focal_px, _, rng):
    """Disparity in 32nds of a pixel, surfaces that wave, near things that grow by 3 px in places, soft edges, shadows."""
    scale, places = focal_px * 0.05, gaussian_filter(rng.random(depth_m.shape), 4)
    grown_px = np.where(places > np.quantile(places, 0.55), maximum_filter(scale / depth_m, 7), scale / depth_m)
    waves_px = smooth_noise(rng, depth_m.shape, 2) * 0.07, smooth_noise(rng, depth_m.shape, 10) * 0.06
    disparity_px = gaussian_filter(grown_px, 1) + waves_px[0] + waves_px[1]
    measured_m = scale / np.maximum(np.round(disparity_px * 32) / 32, 0.3)
    return np.where(hidden(scale / depth_m) | (measured_m > 6), 0, measured_m)


def time_of_flight(depth_m, _, color, rng):
    """Noise that grows with distance and darkness, pixels between the two sides of an edge, no depth of what is black."""
    brightness = color.mean(axis=2) / 255
    noise_m = rng.normal(size=depth_m.shape) * (0.0012 + 0.00075 * depth_m * depth_m / np.maximum(brightness, 0.15) ** 0.5)
    near_m, far_m = minimum_filter(depth_m, 3), maximum_filter(depth_m, 3)
    is_between = (far_m - near_m > 0.03) & (rng.random(depth_m.shape) < 0.6)
    between_m = near_m + (far_m - near_m) * rng.random(depth_m.shape)
    measured_m = gaussian_filter(np.where(is_between, between_m, depth_m + noise_m), 0.5)
    return np.where((brightness < 0.03) | (measured_m > 5.5), 0, measured_m)


# How it measures, width and height of its image in pixels, and its vertical field of view in degrees.
SENSORS = {"kinect": (kinect, 640, 480, 46), "stereo": (stereo, 1280, 720, 42), "tof": (time_of_flight, 640, 576, 60)}


def write_scene(kind, sensor, seed, folder):
    measure, width, height, field_deg = SENSORS[sensor]
    focal_px = height / 2 / np.tan(np.radians(field_deg / 2))
    with tempfile.TemporaryDirectory() as assets:
        scene = Scene(kind, seed, Path(assets))
        model, data = scene.settle(field_deg)
    with mujoco.Renderer(model, height, width) as renderer:
        color, depth_m, segments = render(renderer, data)
    # Body 0 is the room, the others are the things. Where there is no geom, there is -1: it counts as the floor, which is geom 0.
    truth = model.geom_bodyid[np.clip(segments[..., 0], 0, None)].astype(np.uint8)
    measured_m = measure(depth_m.astype(float), focal_px, color, np.random.default_rng(seed + 7))
    depth = np.round(measured_m * DEPTH_PER_M).clip(0, 65535).astype(np.uint16)
    color = np.clip(color + np.random.default_rng(seed).normal(size=color.shape) * 2.5, 0, 255).astype(np.uint8)
    images = {"truth": truth, "rgb/000000": color, "depth/000000": depth}
    for k in range(len(scene.kinds)):
        if np.sum(truth == k + 1) >= LEAST_MASK_PX:
            images[f"mask_visib/000000_{k:06d}"] = ((truth == k + 1) * 255).astype(np.uint8)
    for name, image in images.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(image).save(folder / f"{name}.png")
    camera = {"cam_K": [focal_px, 0, (width - 1) / 2, 0, focal_px, (height - 1) / 2, 0, 0, 1], "depth_scale": 1000 / DEPTH_PER_M}
    (folder / "scene_camera.json").write_text(json.dumps({"0": camera}))
    (folder / "kinds.json").write_text(json.dumps(scene.kinds))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("sensor", choices=SENSORS)
    for name, kind in (("first_seed", int), ("scenes", int), ("folder", Path)):
        parser.add_argument(name, type=kind)
    options = parser.parse_args()
    for seed in range(options.first_seed, options.first_seed + options.scenes):
        write_scene(options.kind, options.sensor, seed, options.folder / f"{options.kind}{seed:03d}")
