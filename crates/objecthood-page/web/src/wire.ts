// What the server says: docs/PAGE.md describes it.

export type Stage = string;
export type Value = number | string | boolean;

export interface Parameter {
  name: string;
  default: string;
  range: string;
  unit: string;
  meaning: string;
  source: string;
  limits: [number, number] | null;
  is_whole: boolean;
  choices: string[];
  /** The first stage that reads it, of `context` and of `paper`. */
  stages: [Stage | null, Stage | null];
}

export interface Settings {
  method: "context" | "paper";
  set: Record<string, Value>;
}

export interface Greeting {
  version: string;
  title: string;
  words: string[];
  frames: string[];
  /** Whether more frames come. */
  grows: boolean;
  settings: Settings;
  parameters: Parameter[];
}

export interface OrientedBox {
  center_m: [number, number, number];
  rotation_xyzw: [number, number, number, number];
  extents_m: [number, number, number];
}

export interface SceneObject {
  id: number;
  objectness: number;
  parts: Record<string, number>;
  size_px: number;
  box_px: { u: number; v: number; width: number; height: number };
  box_m: OrientedBox;
  top_m?: number | null;
  flat: boolean;
  facets: number;
  node: number;
  parents: number[];
}

export interface SupportNode {
  object?: number | null;
  plane?: number | null;
  size_px: number;
}

export interface SupportEdge {
  lower: number;
  upper: number;
  kind: string;
  confidence: number;
  hidden: boolean;
}

export interface Scene {
  image: { width_px: number; height_px: number };
  camera: { fx_px: number; fy_px: number; cx_px: number; cy_px: number };
  up: { direction: [number, number, number]; source: string };
  objects: SceneObject[];
  support: { nodes: SupportNode[]; edges: SupportEdge[] };
  notices: string[];
}

export interface Score {
  correct: number;
  objects: { verdict: string; iou: number; pixels: number }[];
  hypotheses: number;
  off_objects: number;
  overlap_f: number | null;
}

interface Place {
  name: string;
  /** `jpeg`: a file instead of numbers, in reports. */
  kind: "u8" | "u16" | "u32" | "i8" | "rgb" | "jpeg";
  width: number;
  height: number;
  unit_m: number | null;
  offset: number;
  length: number;
}

export interface Header {
  frame: number;
  name: string;
  settings: Settings;
  values: Record<string, Value>;
  scene: Scene;
  truth: Score | null;
  stages_ms: [Stage, number][];
  /** Of a video: where each track was until now (m, in this frame's camera). */
  paths?: [number, [number, number, number][]][];
  maps: Place[];
}

export type Numbers = Uint8Array | Uint16Array | Uint32Array | Int8Array;

export interface PixelMap {
  width: number;
  height: number;
  unit_m: number | null;
  data: Numbers;
}

/** A frame as it was looked at. */
export interface Picture {
  header: Header;
  maps: Map<string, PixelMap>;
  /** Which of the colours an object has; its number says so for others. */
  colors: Map<number, number>;
  /** The settings that it shows; a report has one. */
  by?: Settings;
}

export function unpack(buffer: ArrayBuffer): Picture {
  const length = new DataView(buffer).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 4, length));
  const header = JSON.parse(text) as Header;
  const maps = new Map<string, PixelMap>();
  for (const { name, kind, width, height, unit_m, offset, length: bytes } of header.maps) {
    const start = 4 + length + offset;
    const data =
      kind === "u16" ? new Uint16Array(buffer, start, bytes / 2)
      : kind === "u32" ? new Uint32Array(buffer, start, bytes / 4)
      : kind === "i8" ? new Int8Array(buffer, start, bytes)
      : new Uint8Array(buffer, start, bytes);
    maps.set(name, { width, height, unit_m, data });
  }
  return { header, maps, colors: new Map() };
}

export interface Flip {
  kind: string;
  parameter?: string;
  from?: number;
  to?: number;
}

export interface Decision {
  flip: Flip;
}

export interface Explanation {
  pixel: [number, number];
  facet?: { facet: number; structure_plane?: number };
  kept?: Decision;
  way: Decision[];
  near_misses: Decision[];
  borders: { facet: number; structure_plane?: number; vote_mm?: number; decision?: Decision }[];
  object?: { object?: number; facets: number[] };
}

export interface Explained {
  text: string;
  explanation: Explanation;
  /** The settings that it explains. */
  by?: Settings;
}

/** A value of a parameter that turns the answer for one pixel or two. */
export interface Repair {
  parameter: string;
  from: Value;
  to: Value;
  /** How many other objects of the frame change, and the same in words. */
  others: number;
  side_effects: string;
}

/** What a search through all parameters found so far, the best first. */
export interface Repairs {
  /** What a repair does. */
  sought: string;
  tried: number;
  left: number;
  found: Repair[];
}

/** What happens in a video. */
export interface Film {
  /** When each frame was taken (s). */
  stamps_s: number[];
  happenings: { time_s: number; track: number; text: string }[];
  /** When each track was seen for the first and for the last time, by its number. */
  lives: Record<string, { first_s: number; last_s: number }>;
}

/** Objects as they were followed to a frame. */
export interface Followed {
  frame: number;
  /** The first frame that was not followed yet. */
  next: number;
  film: Film;
  /** Once the frame was followed. */
  paths?: Header["paths"];
  tracks?: PixelMap;
  /** Once the frame was passed over: why nothing is said of it. */
  silence?: string;
}

/** What the server refuses, in its words. */
export class Refusal extends Error {}

const TAB = crypto.getRandomValues(new Uint32Array(1))[0];

/** Nobody answers: the program has ended. */
const ENDED = "objecthood does not answer: it has ended. Start `objecthood view` again, and open the address that it prints.";

/** What went wrong, for the reader of the page. */
export function wordsOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

async function answered(asked: Promise<Response>): Promise<Response> {
  const response = await asked.catch(() => {
    throw new Refusal(ENDED);
  });
  if (!response.ok) {
    const said = await response.json().catch(() => ({}));
    throw new Refusal((said as { error?: string }).error ?? `the server answered ${response.status}`);
  }
  return response;
}

function post(path: string, body: object): Promise<Response> {
  return answered(fetch(path, { method: "POST", body: JSON.stringify({ tab: TAB, ...body }) }));
}

export async function greet(): Promise<Greeting> {
  return (await answered(fetch("session"))).json();
}

/** Looks at a frame. `side`: 0 and 1 are compared, 2 is the contact sheet. */
export async function look(side: number, frame: number, settings: Settings, maps: string[]): Promise<Picture> {
  return unpack(await (await post("look", { side, frame, settings, maps })).arrayBuffer());
}

/** Follows objects towards a frame, as far as the server gets in a moment. */
export async function follow(frame: number, settings: Settings): Promise<Followed> {
  const { header, maps } = unpack(await (await post("follow", { side: 3, frame, settings })).arrayBuffer());
  return { ...(header as unknown as Followed), tracks: maps.get("tracks") };
}

export async function explain(
  frame: number,
  settings: Settings,
  pixel: [number, number],
  in_full: boolean,
): Promise<Explained> {
  return (await post("explain", { frame, settings, pixel, in_full })).json();
}

/** Goes on with a search through all parameters for a moment. */
export async function repair(
  frame: number,
  settings: Settings,
  pixel: [number, number],
  other: [number, number] | null,
): Promise<Repairs> {
  return (await post("repair", { side: 4, frame, settings, pixel, with: other })).json();
}

/** Tells the server that the tab is closed. */
export function bye(): void {
  navigator.sendBeacon("close", JSON.stringify({ tab: TAB }));
}
