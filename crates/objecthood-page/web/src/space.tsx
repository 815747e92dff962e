// The points in space, in the colours of the picture, with the boxes of the objects.

import { useEffect, useRef } from "preact/hooks";
import {
  ArrowHelper, BoxGeometry, BufferAttribute, BufferGeometry, Color, EdgesGeometry, Group, Line, LineBasicMaterial, LineSegments,
  PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene as Space, SRGBColorSpace, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { colorOf, objectColor } from "./paint";
import { painted } from "./picture";
import { pictures, selected } from "./state";
import { Picture, PixelMap, Scene } from "./wire";

/** More points than these make old graphics slow, and no picture better. */
const MOST_POINTS = 320_000;

/** What is drawn, and what draws it. Its axes are those of a camera in graphics: x right, y up, z backwards. */
class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly space = new Space();
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 200);
  private readonly controls: OrbitControls;
  private readonly points = new Points(new BufferGeometry(), new PointsMaterial({ size: 1.5, sizeAttenuation: false, vertexColors: true }));
  private readonly boxes = new Group();
  /** The pixel of every point. */
  private pixels = new Uint32Array(0);
  private depth: PixelMap | null = null;
  private due = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.space.add(this.points, this.boxes);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener("change", () => this.redraw());
  }

  redraw(): void {
    this.due ||= requestAnimationFrame(() => {
      this.due = 0;
      const { clientWidth: width, clientHeight: height } = this.canvas;
      if (width === 0 || height === 0) return;
      this.renderer.setPixelRatio(devicePixelRatio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.space, this.camera);
    });
  }

  /** New points, looked at from the camera, unless they are those that are shown. */
  place(depth: PixelMap, scene: Scene): void {
    if (depth === this.depth) return;
    const { fx_px, fy_px, cx_px, cy_px } = scene.camera;
    const step = Math.max(1, Math.ceil(Math.sqrt((depth.width * depth.height) / MOST_POINTS)));
    const [places, pixels]: [number[], number[]] = [[], []];
    for (let v = 0; v < depth.height; v += step) {
      for (let u = 0; u < depth.width; u += step) {
        const i = v * depth.width + u;
        const z = depth.data[i] * (depth.unit_m ?? 0);
        if (z <= 0) continue;
        places.push(((u - cx_px) / fx_px) * z, (-(v - cy_px) / fy_px) * z, -z);
        pixels.push(i);
      }
    }
    const isFirst = this.depth === null;
    this.depth = depth;
    this.pixels = Uint32Array.from(pixels);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(places), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(places.length), 3));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
    if (isFirst) this.lookFrom(places, scene);
  }

  /** From where the camera stood, a little aside, around the middle of the points. */
  private lookFrom(places: number[], scene: Scene): void {
    const middle = places.filter((_, k) => k % 3 === 2).sort((a, b) => a - b)[Math.floor(places.length / 6)] ?? -1;
    this.controls.target.set(0, 0, middle);
    this.camera.position.set(-0.25 * middle * -1, -0.35 * middle, 0.1 * middle);
    const [x, y, z] = scene.up.direction;
    this.camera.up.set(x, -y, -z);
    this.controls.update();
  }

  /** The colours of the picture. */
  paint(image: ImageData): void {
    const colors = this.points.geometry.getAttribute("color") as BufferAttribute | undefined;
    if (!colors) return;
    const color = new Color();
    this.pixels.forEach((pixel, k) => {
      const from = 4 * pixel;
      color.setRGB(image.data[from] / 255, image.data[from + 1] / 255, image.data[from + 2] / 255, SRGBColorSpace);
      colors.setXYZ(k, color.r, color.g, color.b);
    });
    colors.needsUpdate = true;
  }

  /** The boxes of the objects, the paths of tracks, and the arrow upwards. */
  frame(picture: Picture, chosen: number | null): void {
    this.boxes.children.forEach((child) => (child as LineSegments).geometry?.dispose());
    this.boxes.clear();
    const { scene, paths } = picture.header;
    for (const [track, points] of paths ?? []) {
      const [r, g, b] = objectColor(track);
      const places = points.map(([x, y, z]) => new Vector3(x, -y, -z));
      const material = new LineBasicMaterial({ color: new Color(`rgb(${r | 0}, ${g | 0}, ${b | 0})`) });
      this.boxes.add(new Line(new BufferGeometry().setFromPoints(places), material));
    }
    for (const { id, box_m } of scene.objects) {
      const [r, g, b] = colorOf(picture, id);
      const lines = new LineSegments(
        new EdgesGeometry(new BoxGeometry(...box_m.extents_m)),
        new LineBasicMaterial({ color: new Color(`rgb(${r | 0}, ${g | 0}, ${b | 0})`), transparent: true, opacity: chosen === null || chosen === id ? 1 : 0.25 }),
      );
      const [x, y, z, w] = box_m.rotation_xyzw;
      const [cx, cy, cz] = box_m.center_m;
      lines.position.set(cx, -cy, -cz);
      // Half a turn about x leads from the axes of the camera to those of graphics.
      lines.quaternion.copy(new Quaternion(1, 0, 0, 0).multiply(new Quaternion(x, y, z, w)));
      this.boxes.add(lines);
    }
    const [x, y, z] = scene.up.direction;
    const arrow = new ArrowHelper(new Vector3(x, -y, -z), this.controls.target, 0.15, 0x009e73);
    this.boxes.add(arrow);
  }

  background(color: string): void {
    this.space.background = new Color(color);
  }

  end(): void {
    cancelAnimationFrame(this.due);
    this.controls.dispose();
    this.points.geometry.dispose();
    this.renderer.dispose();
  }
}

export function SpaceView() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const stage = useRef<Stage | null>(null);
  const picture = pictures[0].value;
  const image = painted[0].value;
  const chosen = selected.value;
  useEffect(() => {
    const element = canvas.current!;
    stage.current = new Stage(element);
    const resized = new ResizeObserver(() => stage.current?.redraw());
    resized.observe(element);
    return () => {
      resized.disconnect();
      stage.current?.end();
    };
  }, []);
  useEffect(() => {
    const depth = picture?.maps.get("depth");
    if (!picture || !depth || !image || !stage.current) return;
    stage.current.background(getComputedStyle(canvas.current!).backgroundColor);
    stage.current.place(depth, picture.header.scene);
    stage.current.paint(image);
    stage.current.frame(picture, chosen);
    stage.current.redraw();
  }, [picture, image, chosen]);
  return (
    <div class="space">
      <canvas ref={canvas} tabIndex={0} aria-label="Points in space. Arrows move, Shift and arrows turn." role="img" />
      <p class="hint">drag turns, wheel nears, right button moves; the green arrow is up</p>
    </div>
  );
}
