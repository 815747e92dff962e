// Pictures out of maps: layers over the colour image, each with an opacity.

import { PixelMap, Picture } from "./wire";

export interface Layer {
  name: string;
  title: string;
  /** What a first-time reader should know. */
  meaning: string;
}

export const LAYERS: Layer[] = [
  { name: "depth", title: "depth", meaning: "near is bright; black has no depth" },
  { name: "normals", title: "normals", meaning: "the tilt of the surface: right is red, up is green, towards you is blue" },
  { name: "structure", title: "structure", meaning: "tables, floors and walls" },
  { name: "superpixels", title: "superpixels", meaning: "stage 1: small regions of one surface" },
  { name: "facets", title: "facets", meaning: "stage 2: faces of shapes" },
  { name: "votes", title: "borders by vote", meaning: "blue joins two facets, orange keeps them apart" },
  { name: "shapes", title: "shapes", meaning: "stage 3: facets joined across convex edges" },
  { name: "clusters", title: "things", meaning: "shapes joined by the rules on their surroundings" },
  { name: "objectness", title: "objectness", meaning: "dark is unlikely, bright is likely" },
  { name: "objects", title: "objects", meaning: "what was found" },
  { name: "truth", title: "truth", meaning: "what should be found, where that is known" },
  { name: "tracks", title: "tracks", meaning: "of a video: objects, whose numbers last" },
];

/** Okabe and Ito's colours, which colour-blind eyes tell apart, then the same ones darker and lighter. */
const OKABE_ITO = [
  [230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0], [204, 121, 167],
];

export function objectColor(id: number): [number, number, number] {
  const [r, g, b] = OKABE_ITO[(id - 1) % 7];
  const turn = Math.floor((id - 1) / 7) % 3;
  const shade = (x: number) => (turn === 0 ? x : turn === 1 ? x * 0.62 : 255 - (255 - x) * 0.5);
  return [shade(r), shade(g), shade(b)];
}

/** The colour of an object of a picture. */
export function colorOf(picture: Picture, id: number): [number, number, number] {
  return objectColor(picture.colors.get(id) ?? id);
}

/** Stops of the colour maps viridis and plasma (matplotlib), between which colours are interpolated. */
const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const PLASMA = [[13, 8, 135], [126, 3, 168], [204, 71, 120], [248, 149, 64], [240, 249, 33]];

function ramp(stops: number[][], share: number): [number, number, number] {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(place), stops.length - 2);
  const at = (c: number) => stops[k][c] + (stops[k + 1][c] - stops[k][c]) * (place - k);
  return [at(0), at(1), at(2)];
}

/** A colour for every number of a map, as r, g, b, and 1 where it shows. */
function table(name: string, picture: Picture, map: PixelMap): Uint8Array {
  if (name === "votes") {
    return filled(256, (k) => {
      const vote = (k > 127 ? k - 256 : k) / 127;
      if (vote === 0) return null;
      const strength = 0.35 + 0.65 * Math.abs(vote);
      const [r, g, b] = vote > 0 ? [0, 114, 178] : [230, 130, 0];
      return [255 - (255 - r) * strength, 255 - (255 - g) * strength, 255 - (255 - b) * strength];
    });
  }
  if (name === "objectness") return filled(256, (k) => (k === 0 ? null : ramp(PLASMA, (k - 1) / 254)));
  const colors = picture.maps.get(`${name}.colors`)?.data;
  if (colors) return filled(colors.length / 3, (k) => (k === 0 ? null : [colors[3 * k], colors[3 * k + 1], colors[3 * k + 2]]));
  let most = 0;
  for (const label of map.data) most = Math.max(most, label);
  return filled(most + 1, (k) => (k === 0 ? null : name === "objects" ? colorOf(picture, k) : objectColor(k)));
}

function filled(count: number, color: (k: number) => number[] | null): Uint8Array {
  const entries = new Uint8Array(4 * count);
  for (let k = 0; k < count; k++) {
    const rgb = color(k);
    if (rgb) entries.set([rgb[0], rgb[1], rgb[2], 1], 4 * k);
  }
  return entries;
}

function depthTable(map: PixelMap): Uint8Array {
  const sorted = Uint16Array.from(map.data as Uint16Array).filter((z) => z > 0).sort();
  const [near, far] = [0.02, 0.98].map((share) => sorted[Math.floor(share * (sorted.length - 1))] ?? 0);
  return filled(65536, (z) => (z === 0 ? [0, 0, 0] : ramp(VIRIDIS, far > near ? (far - z) / (far - near) : 0.5)));
}

/** What of the opacity of the objects is left below an explanation. */
const DIMMED = 0.6;

/** Composes the colour image and the layers over it. Where there is no colour, depth is shaded grey. */
export function compose(picture: Picture, opacity: Map<string, number>, marks: Marks): ImageData {
  const { width_px: width, height_px: height } = picture.header.scene.image;
  const out = new Uint8ClampedArray(4 * width * height).fill(255);
  const color = picture.maps.get("color");
  const depth = picture.maps.get("depth");
  if (color) {
    for (let i = 0, o = 0; i < color.data.length; i += 3, o += 4) {
      out[o] = color.data[i]; out[o + 1] = color.data[i + 1]; out[o + 2] = color.data[i + 2];
    }
  } else if (depth) {
    const entries = depthTable(depth);
    for (let i = 0, o = 0; i < depth.data.length; i++, o += 4) {
      const e = 4 * depth.data[i];
      out[o] = out[o + 1] = out[o + 2] = 0.3 * entries[e] + 0.6 * entries[e + 1] + 0.1 * entries[e + 2];
    }
  }
  for (const { name } of LAYERS) {
    const map = picture.maps.get(name);
    // What an explanation paints is not to be mistaken for an object.
    const share = (opacity.get(name) ?? 0) * (name === "objects" && marks.explains ? DIMMED : 1);
    if (map && share > 0) blend(out, name, picture, map, share);
  }
  marks.draw(out, width, height, picture);
  return new ImageData(out, width, height);
}

function blend(out: Uint8ClampedArray, name: string, picture: Picture, map: PixelMap, share: number): void {
  const { data } = map;
  const rest = 1 - share;
  if (name === "normals") {
    for (let i = 0, o = 0; i < data.length; i += 3, o += 4) {
      out[o] = out[o] * rest + data[i] * share;
      out[o + 1] = out[o + 1] * rest + data[i + 1] * share;
      out[o + 2] = out[o + 2] * rest + data[i + 2] * share;
    }
    return;
  }
  const entries = name === "depth" ? depthTable(map) : table(name, picture, map);
  const outlined = ["objects", "truth", "tracks"].includes(name);
  for (let i = 0, o = 0; i < data.length; i++, o += 4) {
    const k = data[i] < 0 ? data[i] + 256 : data[i];
    const e = 4 * k;
    if (!entries[e + 3]) continue;
    const edge = outlined && (data[i + 1] !== data[i] || data[i + map.width] !== data[i]);
    const own = edge ? 1 : share;
    out[o] = out[o] * (1 - own) + entries[e] * own;
    out[o + 1] = out[o + 1] * (1 - own) + entries[e + 1] * own;
    out[o + 2] = out[o + 2] * (1 - own) + entries[e + 2] * own;
  }
}

/** What is pointed out: an object, and the facets of an explanation. */
export class Marks {
  constructor(
    /** The object to outline. */
    private readonly object: number | null,
    /** The object of the explanation. */
    private readonly whole: number | null,
    private readonly facet: number | null,
    private readonly joined: Set<number>,
    private readonly apart: Set<number>,
    /** The facet of the row below the pointer. */
    private readonly pointed: number | null,
  ) {}

  /** Whether facets of an explanation are painted. */
  get explains(): boolean {
    return this.facet !== null;
  }

  draw(out: Uint8ClampedArray, width: number, height: number, picture: Picture): void {
    const paint = (map: PixelMap | undefined, color: (label: number, i: number) => number[] | null) => {
      if (!map) return;
      const { data } = map;
      for (let i = 0; i < data.length; i++) {
        const rgb = color(data[i], i);
        if (!rgb) continue;
        const u = i % width;
        const inside = u > 1 && u < width - 2 && i >= 2 * width && i < (height - 2) * width;
        const edge = !inside || data[i - 1] !== data[i] || data[i + 1] !== data[i]
          || data[i - width] !== data[i] || data[i + width] !== data[i]
          || data[i - 2] !== data[i] || data[i + 2] !== data[i];
        const share = edge ? 1 : rgb[3];
        for (let c = 0; c < 3; c++) out[4 * i + c] = out[4 * i + c] * (1 - share) + rgb[c] * share;
      }
    };
    const objects = picture.maps.get("objects")?.data;
    // Of the table only the bottom of a plate belongs to the plate.
    const isWhole = (i: number) => this.whole === null || !objects || objects[i] === this.whole;
    paint(picture.maps.get("filled"), (label, i) =>
      label === 0 ? null
      : label - 1 === this.pointed ? [204, 121, 167, 0.8]
      : label - 1 === this.facet ? [240, 228, 66, 0.55]
      : this.joined.has(label - 1) && isWhole(i) ? [0, 114, 178, 0.35]
      : this.apart.has(label - 1) ? [230, 130, 0, 0.25]
      : null);
    if (this.object !== null) {
      paint(picture.maps.get("objects"), (label) => (label === this.object ? [255, 255, 255, 0] : null));
    }
  }
}

/** Nothing is pointed out. */
export const UNMARKED = new Marks(null, null, null, new Set(), new Set(), null);
