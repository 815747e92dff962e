#!/usr/bin/env python3
"""Videos with truth by MuJoCo, a simulator that is not ours: what leans on the looks of our own synthetic world shows here.

    pip install mujoco numpy pillow scipy          # renders by EGL; libegl1 and libgl1-mesa-dri are enough
    python mujoco_clips.py drop 1 clips/drop1      # kinds: drop throw push pick wait orbit static
    objecthood track clips/drop1 --out found/drop1
    objecthood eval --tracks found/drop1 --truth clips/drop1

The same kind and seed make the same clip. Truth are the masks, what stands on what, and what happened (`mujoco_events.py`). Lengths are
metres, times seconds, angles degrees.
"""

import argparse
import json
import os
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")
import mujoco  # noqa: E402  reads the variable
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402
from scipy.ndimage import gaussian_filter  # noqa: E402

from mujoco_events import Tape, events  # noqa: E402

WIDTH, HEIGHT, FIELD_DEG = 640, 480, 48.0
FOCAL_PX = HEIGHT / 2 / np.tan(np.radians(FIELD_DEG / 2))
STEP_S = 0.001
DEPTH_SCALE = 5000.0
SECONDS = {"drop": 5.0, "throw": 4.0, "push": 6.0, "pick": 6.0, "wait": 6.0, "orbit": 5.0, "static": 3.4}
THINGS = {"drop": 5, "throw": 8, "push": 5, "pick": 5, "wait": 5, "orbit": 8, "static": 8}
FLOOR, WALL, TABLE, FIRST_THING, HAND = 1, 2, 5, 10, 90
WITH_HAND = ("push", "pick", "wait")
SKIN, SLEEVE = 'rgba="0.8 0.6 0.5 1"', 'rgba="0.2 0.25 0.4 1"'


def numbers(values):
    return " ".join(f"{value:.4f}" for value in values)


def geom(kind, size, at=(0, 0, 0), euler=(0, 0, 0), looks="", more=""):
    return f'<geom type="{kind}" size="{numbers(size)}" pos="{numbers(at)}" euler="{numbers(euler)}" {looks} {more}/>'


def thing_shape(rng):
    """A random shape: its geoms (kind, size, place, angles), and the height of its middle when it stands."""
    kind = rng.choice(["box", "box", "cylinder", "sphere", "capsule", "ellipsoid", "hammer", "mug"])
    if kind == "box":
        size = rng.uniform([0.025, 0.025, 0.02], [0.08, 0.08, 0.09])
        return [("box", size, (0, 0, 0), (0, 0, 0))], size[2]
    if kind == "cylinder":
        size = rng.uniform([0.025, 0.03], [0.05, 0.1])
        return [("cylinder", size, (0, 0, 0), (0, 0, 0))], size[1]
    if kind == "sphere":
        radius = rng.uniform(0.03, 0.06)
        return [("sphere", [radius], (0, 0, 0), (0, 0, 0))], radius
    if kind == "capsule":
        size = rng.uniform([0.02, 0.03], [0.035, 0.07])
        return [("capsule", size, (0, 0, 0), (0, 90, 0))], size[0]
    if kind == "ellipsoid":
        size = rng.uniform([0.03, 0.03, 0.025], [0.07, 0.05, 0.05])
        return [("ellipsoid", size, (0, 0, 0), (0, 0, 0))], size[2]
    if kind == "hammer":
        half = rng.uniform(0.07, 0.1)
        handle = ("box", [half, 0.015, 0.012], (0, 0, 0), (0, 0, 0))
        return [handle, ("box", [0.025, 0.05, 0.02], (half, 0, 0.008), (0, 0, 0))], 0.012
    radius, half = rng.uniform([0.035, 0.04], [0.05, 0.06])
    mug = [("cylinder", [radius, 0.004], (0, 0, -half), (0, 0, 0))]
    for angle in np.arange(16) / 16 * 360:
        at = (radius * np.cos(np.radians(angle)), radius * np.sin(np.radians(angle)), 0)
        mug.append(("box", [0.003, radius * np.pi / 16 * 1.1, half], at, (0, 0, angle)))
    for z in (0.02, -0.02):
        mug.append(("box", [0.02, 0.005, 0.005], (radius + 0.015, 0, z), (0, 0, 0)))
    mug.append(("box", [0.005, 0.005, 0.025], (radius + 0.035, 0, 0), (0, 0, 0)))
    return mug, half


def paint(rng, name):
    """Assets and the looks of a thing: one colour, a checker or a gradient."""
    kind = rng.choice(["flat", "checker", "gradient"], p=[0.6, 0.2, 0.2])
    colors = rng.uniform(0.1, 0.95, (2, 3))
    if kind == "flat":
        return "", f'rgba="{numbers(colors[0])} 1"'
    texture = f'<texture name="{name}" type="cube" builtin="{kind}" rgb1="{numbers(colors[0])}" rgb2="{numbers(colors[1])}"'
    return f'{texture} width="64" height="64"/><material name="{name}" texture="{name}"/>', f'material="{name}"'


def hand(at):
    fingers = [((0.02, 0.07, -0.01), 0.03), ((-0.005, 0.075, -0.01), 0.032), ((-0.03, 0.065, -0.01), 0.028)]
    parts = [geom("box", [0.035, 0.045, 0.015], looks=SKIN)]
    parts += [geom("capsule", [0.011, half], at, (90, 0, 0), SKIN) for at, half in fingers]
    parts.append(geom("capsule", [0.012, 0.025], (0.045, 0.02, -0.015), (90, 30, 0), SKIN))
    parts.append(geom("capsule", [0.03, 0.12], (0, -0.15, 0.03), (75, 0, 0), SKIN))
    parts.append(geom("capsule", [0.045, 0.3], (0, -0.55, 0.16), (72, 0, 0), SLEEVE))
    return f'<body name="hand" mocap="true" pos="{numbers(at)}">{"".join(parts)}</body>'


class World:
    """The scene, and who moves when."""

    def __init__(self, kind, seed):
        self.kind, self.rng = kind, np.random.default_rng([seed, sum(map(ord, kind))])
        rng = self.rng
        has_table = kind in ("drop", *WITH_HAND) and seed % 3 != 2
        self.ground_m = 0.75 if has_table else 0.0
        self.heights_m, self.parked, self.moves, self.grips = [], {}, [], []
        # Where the hand is at first: out of the image, or at rest in it.
        self.hand_m = [0.1, -0.42, self.ground_m + 0.12] if kind == "wait" else [0, -1.3, self.ground_m + 0.35]
        self.azimuth, self.elevation = np.radians(rng.uniform([-110, 28], [-70, 55]))
        self.distance_m = rng.uniform(1.1, 1.5)
        self.model = mujoco.MjModel.from_xml_string(self.describe(has_table))
        self.data = mujoco.MjData(self.model)
        self.bodies = [self.model.body(f"thing{k}").id for k in range(THINGS[kind])]
        self.instances = self.instances_of_geoms()
        self.park()
        for _ in range(1200):
            self.step(None)
        self.plan()

    def describe(self, has_table):
        rng, count = self.rng, THINGS[self.kind]
        spread_m, places = 0.5 if self.kind == "throw" else 0.32, []
        assets, things = "", ""
        for k in range(count):
            for _ in range(200):
                place = rng.uniform(-spread_m, spread_m, 2)
                if all(np.hypot(*(place - other)) > 0.17 for other in places):
                    break
            places.append(place)
            shape, height_m = thing_shape(rng)
            self.heights_m.append(height_m)
            asset, looks = paint(rng, f"paint{k}")
            assets += asset
            geoms = "".join(geom(*part, looks, 'density="400" friction="0.9 0.01 0.002"') for part in shape)
            at = numbers([*place, self.ground_m + height_m + 0.002])
            things += f'<body name="thing{k}" pos="{at}" euler="0 0 {rng.uniform(0, 360)}"><freejoint/>{geoms}</body>'
        color = rng.uniform(0.1, 0.95, 3)
        floor = f'builtin="{rng.choice(["checker", "flat", "gradient"])}" rgb1="{numbers(color)}" rgb2="{numbers(0.7 * color)}"'
        assets += f'<texture name="floor" type="2d" {floor} width="256" height="256"/>'
        assets += '<material name="floor" texture="floor" texrepeat="8 8"/>'
        room = '<geom name="floor" type="plane" size="4 4 .1" material="floor"/>'
        if rng.random() < 0.6:
            room += f'<geom name="wall" type="box" size="4 .05 2" pos="0 {rng.uniform(0.9, 2)} 1" rgba=".7 .8 .75 1"/>'
        if has_table:
            looks = f'rgba="{numbers(rng.uniform(0.1, 0.95, 3))} 1"'
            room += f'<geom name="table" type="box" size=".6 .45 .02" pos="0 0 {self.ground_m - 0.02}" {looks}/>'
            half = (self.ground_m - 0.04) / 2
            for x in (-0.55, 0.55):
                room += "".join(geom("box", [0.025, 0.025, half], (x, y, half), looks=looks) for y in (-0.4, 0.4))
        has_hand = self.kind in WITH_HAND
        welds = "".join(f'<weld name="weld{k}" body1="hand" body2="thing{k}" active="false"/>' for k in range(count))
        return f"""<mujoco><option timestep="{STEP_S}"/>
            <visual><global offwidth="{WIDTH}" offheight="{HEIGHT}" fovy="{FIELD_DEG}"/><map znear="0.05" zfar="20"/></visual>
            <asset>{assets}</asset>
            <worldbody>
                <light pos="{rng.uniform(-1, 1)} -1 3" dir="0 .2 -1" diffuse=".7 .7 .7"/>
                <light pos="1 1 3" dir="-.2 -.2 -1" diffuse=".3 .3 .3" castshadow="false"/>
                {room}{things}{hand(self.hand_m) if has_hand else ""}<camera name="camera"/>
            </worldbody>
            <equality>{welds if has_hand else ""}</equality></mujoco>"""

    def instances_of_geoms(self):
        model, names = self.model, {"floor": FLOOR, "wall": WALL}
        of_body = {body: FIRST_THING + k for k, body in enumerate(self.bodies)}
        if self.kind in WITH_HAND:
            of_body[model.body("hand").id] = HAND
        of_geom = lambda g: of_body.get(model.geom_bodyid[g], names.get(model.geom(g).name, TABLE))  # noqa: E731
        return np.array([of_geom(g) for g in range(model.ngeom)])

    def park(self):
        """What falls or is thrown waits far away: `parked` says when it comes."""
        first = {"drop": 1, "throw": 5}.get(self.kind, len(self.bodies))
        self.parked = {k: 0.6 + 0.8 * (k - first) for k in range(first, len(self.bodies))}

    def plan(self):
        """The ways of the hand: (start, target, duration), and what it grips and lets go: (time, thing, whether it grips)."""
        if self.kind not in WITH_HAND:
            return
        away, ground_m, at = [0, -1.3, self.ground_m + 0.35], self.ground_m, self.data.xpos
        order = self.rng.permutation(len(self.bodies))
        if self.kind == "push":
            start_s = 0.8
            for x, y, _ in at[[self.bodies[k] for k in order[:2]]]:
                self.moves += [
                    (start_s, [x, y - 0.3, ground_m + 0.2], 0.5),
                    (start_s + 0.5, [x, y - 0.22, ground_m + 0.04], 0.3),
                    (start_s + 0.8, [x, y + 0.04, ground_m + 0.04], 0.7),
                    (start_s + 1.6, [x, y - 0.4, ground_m + 0.25], 0.5),
                ]
                start_s += 2.3
            self.moves.append((start_s, away, 0.6))
            return
        thing = order[0]
        x, y, z = at[self.bodies[thing]]
        others = [at[body][:2] for body in self.bodies]
        for _ in range(200):
            goal = self.rng.uniform(-0.3, 0.3, 2)
            if all(np.hypot(*(other - goal)) > 0.2 for other in others):
                break
        grip_m = z + self.heights_m[thing] + 0.03
        self.moves = [
            (0.8, [x, y - 0.03, grip_m + 0.2], 0.7),
            (1.6, [x, y - 0.03, grip_m], 0.4),
            (2.2, [x, y - 0.03, grip_m + 0.22], 0.6),
            (2.9, [goal[0], goal[1] - 0.03, grip_m + 0.22], 0.7),
            (3.7, [goal[0], goal[1] - 0.03, grip_m + 0.004], 0.5),
            (4.35, [goal[0], goal[1] - 0.06, grip_m + 0.2], 0.5),
            (4.9, away, 0.7),
        ]
        self.grips = [(2.1, thing, True), (4.3, thing, False)]

    def step(self, time_s):
        """One step of the physics; before the clip begins `time_s` is None."""
        model, data = self.model, self.data
        for k, comes_s in list(self.parked.items()):
            joint = model.joint(model.body_jntadr[self.bodies[k]])
            place, speed = joint.qposadr[0], joint.dofadr[0]
            if time_s is None or time_s < comes_s:
                data.qpos[place : place + 3], data.qvel[speed : speed + 6] = [3 + k, 3, 1], 0
                continue
            del self.parked[k]
            spin = self.rng.normal(size=3) * 2
            if self.kind == "drop":
                start = [*self.rng.uniform(-0.25, 0.25, 2), self.ground_m + self.rng.uniform(0.7, 0.9)]
                velocity = self.rng.normal(size=3) * 0.1
            else:
                angle, goal = self.rng.uniform(0, 2 * np.pi), self.rng.uniform(-0.2, 0.2, 2)
                side = 0.9 * np.array([np.cos(angle), np.sin(angle)])
                start, velocity = [*side, self.ground_m + 0.45], [*(goal - side) / 0.42, 0.8]
            data.qpos[place : place + 3], data.qvel[speed : speed + 6] = start, [*velocity, *spin]
        if time_s is not None:
            self.move_hand(time_s)
        mujoco.mj_step(model, data)

    def move_hand(self, time_s):
        begun = [move for move in self.moves if move[0] <= time_s]
        if begun:
            start_s, target, duration_s = begun[-1]
            origin = begun[-2][1] if len(begun) > 1 else self.hand_m
            share = np.clip((time_s - start_s) / duration_s, 0, 1)
            self.data.mocap_pos[0] = np.array(origin) + (np.array(target) - origin) * share**2 * (3 - 2 * share)
        for at_s, thing, grips in self.grips:
            if abs(at_s - time_s) < STEP_S / 2:
                weld, body = self.model.equality(f"weld{thing}").id, self.bodies[thing]
                self.model.eq_data[weld, 0:3] = 0
                self.model.eq_data[weld, 3:6] = self.data.xpos[body] - self.data.mocap_pos[0]
                self.model.eq_data[weld, 6:10], self.model.eq_data[weld, 10] = self.data.xquat[body], 1
                self.data.eq_active[weld] = grips

    def place_camera(self, time_s):
        turns = self.kind == "orbit"
        azimuth = self.azimuth + (0.6 * np.sin(0.5 * time_s) if turns else 0)
        elevation = self.elevation + (0.1 * np.sin(0.7 * time_s) if turns else 0)
        back = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)])
        right = np.cross([0, 0, 1], back)
        right /= np.linalg.norm(right)
        rotation = np.stack([right, np.cross(back, right), back], axis=1)
        camera, quaternion = self.model.camera("camera").id, np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, rotation.flatten())
        self.model.cam_pos[camera] = [0, 0, self.ground_m + 0.05] + self.distance_m * back
        self.model.cam_quat[camera] = quaternion
        mujoco.mj_forward(self.model, self.data)

    def contacts(self):
        """By thing: what touches it, and how much the contact holds it from below."""
        touching = {FIRST_THING + k: [] for k in range(len(self.bodies))}
        for contact in self.data.contact[: self.data.ncon]:
            one, other = self.instances[contact.geom1], self.instances[contact.geom2]
            upwards = contact.frame[2]
            if one in touching:
                touching[one].append((int(other), -upwards))
            if other in touching:
                touching[other].append((int(one), upwards))
        return touching

    def is_held(self, k):
        return self.kind in ("pick", "wait") and bool(self.data.eq_active[self.model.equality(f"weld{k}").id])

    def bottom_m(self, k):
        """The height of the lowest point of a thing."""
        model, lowest_m = self.model, np.inf
        for g in np.flatnonzero(model.geom_bodyid == self.bodies[k]):
            size, up = model.geom_size[g], self.data.geom_xmat[g].reshape(3, 3)[2]
            form = mujoco.mjtGeom(model.geom_type[g]).name
            reach_m = {
                "mjGEOM_SPHERE": size[0],
                "mjGEOM_BOX": np.abs(up) @ size,
                "mjGEOM_ELLIPSOID": np.linalg.norm(up * size),
                "mjGEOM_CAPSULE": size[0] + abs(up[2]) * size[1],
                "mjGEOM_CYLINDER": size[0] * np.hypot(up[0], up[1]) + abs(up[2]) * size[1],
            }[form]
            lowest_m = min(lowest_m, self.data.geom_xpos[g][2] - reach_m)
        return float(lowest_m)


def kinect(depth_m, rng):
    """Depth (m) as a Kinect gives it: eighths of a pixel of disparity, noise that neighbours share, shaking edges, shadows; 0 = none."""
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    shaken = [(at + rng.normal(size=at.shape) * 0.5).round().astype(int) for at in (rows, columns)]
    seen_m = depth_m[np.clip(shaken[0], 0, HEIGHT - 1), np.clip(shaken[1], 0, WIDTH - 1)]
    noise = gaussian_filter(rng.normal(size=depth_m.shape), 1.2)
    disparity = FOCAL_PX * 0.075 / seen_m + noise / noise.std() * 0.055
    measured_m = FOCAL_PX * 0.075 / (np.round(disparity * 8) / 8)
    # The projector is 75 mm to the right: what a nearer thing hides from it has no depth.
    lit_px = columns - FOCAL_PX * 0.075 / depth_m
    nearest_px = np.minimum.accumulate(lit_px[:, ::-1], axis=1)[:, ::-1]
    hidden = np.zeros(depth_m.shape, bool)
    hidden[:, :-1] = lit_px[:, :-1] > nearest_px[:, 1:] + 1
    measured_m[hidden | (measured_m > 8)] = 0
    return measured_m


class Alone:
    """Renders a thing as if nothing hid it, in a quarter of the image's width and height."""

    def __init__(self, world):
        self.world, self.renderer = world, mujoco.Renderer(world.model, HEIGHT // 4, WIDTH // 4)
        self.renderer.enable_segmentation_rendering()
        self.shown = mujoco.MjvOption()
        self.shown.geomgroup[:] = [0, 1, 0, 0, 0, 0]

    def mask(self, instance):
        model = self.world.model
        model.geom_group[:] = self.world.instances == instance
        self.renderer.update_scene(self.world.data, camera="camera", scene_option=self.shown)
        model.geom_group[:] = 0
        return self.renderer.render()[..., 0] >= 0


def write_clip(kind, seed, folder):
    world, rng = World(kind, seed), np.random.default_rng(seed)
    frames_per_s = [30, 24, 30, 15][seed % 4]
    for part in ("color", "depth", "truth"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    camera = dict(fx=FOCAL_PX, fy=FOCAL_PX, cx=(WIDTH - 1) / 2, cy=(HEIGHT - 1) / 2, width=WIDTH, height=HEIGHT)
    (folder / "camera.json").write_text(json.dumps({**camera, "depth_scale": DEPTH_SCALE}))
    renderer, steps = mujoco.Renderer(world.model, HEIGHT, WIDTH), 0
    lists = {name: [] for name in ("rgb.txt", "depth.txt", "truth.jsonl", "support.jsonl", "events.jsonl")}
    tapes, alone = {FIRST_THING + k: Tape(FIRST_THING + k) for k in range(len(world.bodies))}, Alone(world)
    for frame in range(int(SECONDS[kind] * frames_per_s)):
        time_s = frame / frames_per_s
        while steps * STEP_S < time_s:
            world.step(steps * STEP_S)
            steps += 1
        world.place_camera(time_s)
        color, depth_m, segments = render(renderer, world.data)
        geoms, is_geom = segments[..., 0], segments[..., 1] == int(mujoco.mjtObj.mjOBJ_GEOM)
        truth = np.where(is_geom, world.instances[np.clip(geoms, 0, None)], 0).astype(np.uint16)
        color = np.clip(color + rng.normal(size=(HEIGHT, WIDTH, 1)) * 3, 0, 255).astype(np.uint8)
        depth = np.round(kinect(depth_m.astype(float), rng) * DEPTH_SCALE).astype(np.uint16)
        stem = f"{time_s:.6f}"
        for part, image in (("color", color), ("depth", depth), ("truth", truth)):
            Image.fromarray(image).save(folder / part / f"{stem}.png")
        lists["rgb.txt"].append(f"{stem} color/{stem}.png")
        lists["depth.txt"].append(f"{stem} depth/{stem}.png")
        solids = []
        for instance, touching in world.contacts().items():
            k, tape, visible_px = instance - FIRST_THING, tapes[instance], int((truth == instance).sum())
            small, mask = truth[2::4, 2::4], alone.mask(instance)
            before = small[mask & (small != instance)]
            tape.seen_px.append(int((small == instance).sum()))
            tape.alone_px.append(int(mask.sum()))
            tape.hider.append(int(np.bincount(before).argmax()) if before.size else None)
            tape.bottom_m.append(world.bottom_m(k))
            tape.center_m.append(world.data.xipos[world.bodies[k]].tolist())
            tape.is_moved.append(world.is_held(k) or any(other == HAND for other, _ in touching))
            tape.is_free.append(k not in world.parked and not world.is_held(k) and not touching)
            solids.append(dict(instance=instance, airborne=tape.is_free[-1] and visible_px > 0))
            below = [(up, other) for other, up in touching if up > 0.35 and other != HAND]
            parent = max(below)[1] if below else None
            tape.parent.append(parent if parent is None or parent >= FIRST_THING else 0)
            if below and visible_px > 30:
                edge = dict(frame=frame, child=instance, parent=tape.parent[-1], kind="on")
                lists["support.jsonl"].append(json.dumps(edge))
        lists["truth.jsonl"].append(json.dumps(dict(frame=frame, time=time_s, solids=solids)))
    happened = [event for tape in tapes.values() for event in events(tape, frames_per_s, HAND)]
    lists["events.jsonl"] = [json.dumps(event) for event in sorted(happened, key=lambda event: event["frame"])]
    for name, lines in lists.items():
        (folder / name).write_text("".join(f"{line}\n" for line in lines))
    agents = [HAND] if kind in WITH_HAND else []
    roles = {FLOOR: "room", WALL: "room", TABLE: "furniture"}
    roles |= {instance: "object" for instance in tapes} | {agent: "agent" for agent in agents}
    solids = [dict(instance=instance, role=role) for instance, role in roles.items()]
    clip = dict(clip=kind, seed=seed, fps=frames_per_s, agents=agents, groups=[], solids=solids)
    (folder / "clip.json").write_text(json.dumps(clip))


def render(renderer, data):
    """Colour, depth (m), and the geom at each pixel."""
    renderer.update_scene(data, camera="camera")
    color = renderer.render().copy()
    renderer.enable_depth_rendering()
    depth_m = renderer.render().copy()
    renderer.disable_depth_rendering()
    renderer.enable_segmentation_rendering()
    segments = renderer.render().copy()
    renderer.disable_segmentation_rendering()
    return color, depth_m, segments


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=sorted(SECONDS))
    parser.add_argument("seed", type=int)
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    write_clip(options.kind, options.seed, options.folder)
