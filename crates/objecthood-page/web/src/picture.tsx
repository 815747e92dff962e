// The picture: layers over colour, with zoom; two of them when settings are compared.

import { computed, effect, signal } from "@preact/signals";
import { useLayoutEffect, useRef } from "preact/hooks";

import { compose, Marks, UNMARKED } from "./paint";
import { namesOf } from "./names";
import {
  ask, asked, askWith, explained, frame as shown, isLive, isPairing, opacity, other, partner, pictures, problem, selected, stopAsking, swipe,
  unfollowed,
} from "./state";
import { Picture } from "./wire";

/** How far the picture is enlarged, and which of its points, as a share of its size, is in the middle. */
const zoom = signal({ factor: 1, u: 0.5, v: 0.5 });
const MOST_ZOOM = 16;
const under = signal("");
/** The pixel that the keyboard moves. */
const cursor = signal<[number, number] | null>(null);

/** The facet that a row of the table of borders is about, while the pointer is over it. */
export const pointed = signal<number | null>(null);

// What was at a pixel of one frame says nothing of another one.
effect(() => {
  void shown.value;
  cursor.value = null;
  under.value = "";
});

/** The explanation, while the picture is of the same settings: facets and objects of others have other numbers. */
const explanation = computed(() => {
  const found = explained.value;
  return found?.by === pictures[0].value?.by ? found?.explanation : undefined;
});

const marks = computed(() => {
  const { facet, object, borders } = explanation.value ?? {};
  const joined = new Set(object?.facets ?? []);
  // Structure has no vote: it is kept apart from everything.
  const apart = new Set((borders ?? []).filter((one) => one.structure_plane === undefined && !joined.has(one.facet)).map((one) => one.facet));
  return new Marks(selected.value, object?.object ?? null, facet?.facet ?? null, joined, apart, pointed.value);
});

/** The pixels of the pictures as they are shown; the points in 3D take their colours from the first. */
export const painted = [0, 1].map((side) =>
  computed(() => {
    const picture = pictures[side].value;
    if (!picture) return null;
    return side === 0 ? compose(picture, opacity.value, marks.value) : compose(picture, unfollowed.value, UNMARKED);
  }),
);

export function zoomBy(times: number, at: { u: number; v: number } = zoom.value): void {
  const { factor, u, v } = zoom.value;
  const next = Math.min(Math.max(factor * times, 1), MOST_ZOOM);
  const share = 1 - factor / next;
  zoom.value = inside({ factor: next, u: u + (at.u - u) * share, v: v + (at.v - v) * share });
}

export function zoomOut(): void {
  zoom.value = { factor: 1, u: 0.5, v: 0.5 };
}

function inside({ factor, u, v }: typeof zoom.value): typeof zoom.value {
  const half = 0.5 / factor;
  const clamp = (x: number) => Math.min(Math.max(x, half), 1 - half);
  return { factor, u: clamp(u), v: clamp(v) };
}

function Canvas({ side }: { side: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const image = painted[side].value;
  // Before the browser shows the page next, so that status and picture appear together.
  useLayoutEffect(() => {
    if (!canvas.current || !image) return;
    if (canvas.current.width !== image.width || canvas.current.height !== image.height) {
      canvas.current.width = image.width;
      canvas.current.height = image.height;
    }
    canvas.current.getContext("2d")?.putImageData(image, 0, 0);
  }, [image]);
  const style = side === 1 ? { clipPath: `inset(0 0 0 ${100 * swipe.value}%)` } : undefined;
  return <canvas ref={canvas} class={`side-${side}`} style={style} aria-hidden="true" />;
}

export function PictureView() {
  const picture = pictures[0].value;
  const frame = useRef<HTMLDivElement>(null);
  if (!picture) return <div class="waiting">{problem.value ? "This frame cannot be shown." : "Reading the frame …"}</div>;
  const { width_px: width, height_px: height } = picture.header.scene.image;
  const { factor, u, v } = zoom.value;
  const place = (e: MouseEvent) => {
    const box = frame.current!.getBoundingClientRect();
    return { u: (e.clientX - box.left) / box.width, v: (e.clientY - box.top) / box.height };
  };
  const pixelAt = (e: MouseEvent): [number, number] => {
    const at = place(e);
    const clamp = (x: number, size: number) => Math.min(Math.max(Math.floor(x * size), 0), size - 1);
    return [clamp(at.u, width), clamp(at.v, height)];
  };
  const style = {
    aspectRatio: `${width} / ${height}`,
    "--ratio": String(width / height),
    transform: `scale(${factor}) translate(${100 * (0.5 - u)}%, ${100 * (0.5 - v)}%)`,
  };
  return (
    <div
      class="stage" tabIndex={0} role="application"
      aria-label={`Picture, ${width} by ${height} pixels. Arrows move a cross, Enter explains the pixel below it, Shift+Enter adds a second pixel, Escape ends.`}
      onWheel={(e) => { e.preventDefault(); zoomBy(e.deltaY < 0 ? 1.25 : 0.8, place(e)); }}
      onKeyDown={(e) => moveCursor(e, width, height)}
    >
      <div
        ref={frame} class="frame" style={style}
        onPointerDown={(e) => drag(e, () => picked(pixelAt(e), e.shiftKey || isPairing.value))}
        onPointerMove={(e) => (under.value = described(picture, pixelAt(e)))}
        onPointerLeave={() => (under.value = "")}
      >
        <Canvas side={0} />
        {other.value && <Canvas side={1} />}
        {other.value && <i class="line" style={{ left: `${100 * swipe.value}%` }} aria-hidden="true" />}
        <Names picture={picture} />
        <Cross at={asked.value} name="A" width={width} height={height} />
        <Cross at={partner.value} name="B" width={width} height={height} />
        {cursor.value?.join() !== asked.value?.join() && <Cross at={cursor.value} name="" width={width} height={height} />}
      </div>
      {factor > 1 && <button class="zoomed" onClick={zoomOut}>{factor.toFixed(1)}× – fit</button>}
      <output class="under">{under.value}</output>
    </div>
  );
}

function picked(pixel: [number, number], isSecond: boolean): void {
  cursor.value = null;
  const label = pictures[0].value ? objectAt(pictures[0].value, pixel) : 0;
  if (isLive.value && settingsCanExplain()) (isSecond ? askWith : ask)(pixel);
  else selected.value = label || null;
}

function settingsCanExplain(): boolean {
  return pictures[0].value?.header.settings.method === "context";
}

function objectAt(picture: Picture, [u, v]: [number, number]): number {
  const map = picture.maps.get("objects");
  return map ? map.data[v * map.width + u] : 0;
}

/** What is known of the pixel below the pointer. */
function described(picture: Picture, [u, v]: [number, number]): string {
  const depth = picture.maps.get("depth");
  const z = depth ? depth.data[v * depth.width + u] * (depth.unit_m ?? 0) : 0;
  const object = objectAt(picture, [u, v]);
  const filled = picture.maps.get("filled");
  const facet = filled ? filled.data[v * filled.width + u] : 0;
  const parts = [z > 0 ? `${z.toFixed(3)} m` : "no depth", object ? `object ${object}` : "no object", facet ? `facet ${facet - 1}` : ""];
  return `${u}, ${v}: ${parts.filter(Boolean).join(", ")}`;
}

/** Tells a click from a drag, which moves the enlarged picture. */
function drag(down: PointerEvent, click: () => void): void {
  if (down.button !== 0) return;
  const target = down.currentTarget as HTMLElement;
  const start = zoom.value;
  let moved = false;
  const box = target.getBoundingClientRect();
  const move = (e: PointerEvent) => {
    const [dx, dy] = [e.clientX - down.clientX, e.clientY - down.clientY];
    if (Math.hypot(dx, dy) > 4) moved = true;
    if (moved && start.factor > 1) zoom.value = inside({ ...start, u: start.u - dx / box.width, v: start.v - dy / box.height });
  };
  const up = () => {
    target.removeEventListener("pointermove", move);
    if (!moved) click();
  };
  target.setPointerCapture(down.pointerId);
  target.addEventListener("pointermove", move);
  target.addEventListener("pointerup", up, { once: true });
}

interface Crossed {
  at: [number, number] | null;
  name: string;
  width: number;
  height: number;
}

function Cross({ at, name, width, height }: Crossed) {
  if (!at) return null;
  return <div class="cross" style={placed(at, width, height)} aria-hidden="true">{name && <b>{name}</b>}</div>;
}

/** The middle of a pixel; what stands there keeps its size when the picture is enlarged. */
function placed([u, v]: [number, number], width: number, height: number) {
  return { left: `${(100 * (u + 0.5)) / width}%`, top: `${(100 * (v + 0.5)) / height}%`, transform: `scale(${1 / zoom.value.factor})` };
}

/** The numbers of the facets that an explanation names, where they are. */
function Names({ picture }: { picture: Picture }) {
  const said = explanation.value;
  const filled = picture.maps.get("filled");
  if (!said?.facet || !filled) return null;
  const { width, height } = filled;
  return (
    <>
      {namesOf(said, filled).map(([facet, at]) => (
        <span key={facet} class={pointed.value === facet ? "facet-name pointed" : "facet-name"} style={placed(at, width, height)} aria-hidden="true">
          {facet}
        </span>
      ))}
    </>
  );
}

const STEPS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Ends a question, and takes the cross away. */
export function endQuestion(): void {
  cursor.value = null;
  stopAsking();
}

function moveCursor(e: KeyboardEvent, width: number, height: number): void {
  const [u, v] = cursor.value ?? partner.value ?? asked.value ?? [Math.floor(width / 2), Math.floor(height / 2)];
  const step = STEPS[e.key];
  if (step) {
    const far = e.shiftKey ? 1 : 10;
    const clamp = (x: number, size: number) => Math.min(Math.max(x, 0), size - 1);
    cursor.value = [clamp(u + far * step[0], width), clamp(v + far * step[1], height)];
    if (pictures[0].value) under.value = described(pictures[0].value, cursor.value);
  } else if (e.key === "Enter") {
    picked([u, v], e.shiftKey || isPairing.value);
  } else {
    return;
  }
  e.preventDefault();
  e.stopPropagation();
}

/** The line between two settings that are compared. */
export function Swipe() {
  if (!other.value) return null;
  const count = (side: number) => pictures[side].value?.header.scene.objects.length ?? "…";
  return (
    <label class="swipe">
      A: {count(0)} objects{" "}
      <input
        type="range" min="0" max="1" step="0.01" value={swipe.value} aria-label="Line between A, to its left, and B"
        onInput={(e) => (swipe.value = e.currentTarget.valueAsNumber)}
      />{" "}
      B: {count(1)} objects
    </label>
  );
}
