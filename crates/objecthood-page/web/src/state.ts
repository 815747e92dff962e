// What the page knows, and how it comes to know more. One request is under way a side; the latest settings win.

import { batch, computed, effect, signal } from "@preact/signals";

import { cameAndWent, keepColors } from "./match";
import { Explained, explain, Film, follow, Followed, Greeting, greet, look, Picture, Settings, Value, wordsOf } from "./wire";

export const greeting = signal<Greeting | null>(null);
export const frame = signal(0);
export const settings = signal<Settings>({ method: "context", set: {} });
/** The settings to compare with, if any. */
export const other = signal<Settings | null>(null);
export const pictures = [signal<Picture | null>(null), signal<Picture | null>(null)];
export const opacity = signal(new Map<string, number>([["objects", 0.45]]));
export const status = signal("");
export const problem = signal("");
export const selected = signal<number | null>(null);
export const asked = signal<[number, number] | null>(null);
/** The second pixel, when the question is about two. */
export const partner = signal<[number, number] | null>(null);
/** Whether the next click chooses the second pixel. */
export const isPairing = signal(false);
export const explained = signal<Explained | null>(null);
export const searching = signal(false);
export const swipe = signal(0.5);
/** What the middle of the page shows, and what its right side. */
export const view = signal<"picture" | "space" | "sheet">("picture");
export const panel = signal<"objects" | "explain" | "story">("objects");
/** What is known of the video. */
export const film = signal<Film | null>(null);
/** Whether there is a server that can look again; a report has none. */
export const isLive = signal(true);
/** The layers that can be shown; null = all. A report holds some. */
export const available = signal<Set<string> | null>(null);

let complaints = 0;

/** Says what went wrong, until a picture is shown that was asked for later. */
export function complain(error: unknown): void {
  complaints++;
  problem.value = wordsOf(error);
}

/** The maps that no parameter changes: they are asked for once a frame. */
const STILL = ["color", "depth", "truth"];

/** Whether objects are to be followed through the frames. */
export function isFollowing(): boolean {
  return (opacity.value.get("tracks") ?? 0) > 0;
}

/** The maps that a picture with the layers of now needs. Tracks come by themselves. */
export function mapsShown(): string[] {
  const shown = [...opacity.value].filter(([name, share]) => share > 0 && name !== "tracks").map(([name]) => name);
  return [...new Set(["color", "depth", "objects", ...shown])].sort();
}

/** The layers of pictures whose objects are not followed, those of side B and of many frames: objects stand in for tracks. */
export const unfollowed = computed(() => {
  const share = opacity.value.get("tracks") ?? 0;
  return share > 0 ? new Map(opacity.value).set("objects", share) : opacity.value;
});

/** The maps that a side needs now. */
function wanted(): string[] {
  return explained.value ? [...mapsShown(), "filled"] : mapsShown();
}

interface Job {
  frame: number;
  settings: Settings;
  maps: string[];
}

/** Changes that follow each other faster (ms), as those of a slider that is drawn, are one change. */
const PAUSE_MS = 1000;

/** What takes longer than this (ms) is said to be under way. */
const SLOW_MS = 300;

/** Keeps one side up to date: a new request begins when the one before it ended, with what is wanted then. */
class Side {
  private due: Job | null = null;
  private busy = false;
  private since = 0;
  /** What was looked at last, and when it was shown. */
  private shown: Job | null = null;
  private shownAt = -Infinity;
  /** The picture before the last change. */
  private base: Picture | null = null;

  constructor(private readonly side: number) {}

  want(job: Job | null): void {
    if (!this.due) this.since = performance.now();
    this.due = job;
    if (!job) pictures[this.side].value = null;
    if (!this.busy) void this.run();
  }

  private async run(): Promise<void> {
    this.busy = true;
    while (this.due) {
      const [job, since, heard] = [this.due, this.since, complaints];
      this.due = null;
      const isSlow = setTimeout(() => this.wait(job), SLOW_MS);
      try {
        const last = pictures[this.side].peek();
        const kept = STILL.filter((name) => last?.header.frame === job.frame && last.maps.has(name));
        const picture = await look(this.side, job.frame, job.settings, job.maps.filter((name) => !kept.includes(name)));
        for (const name of kept) picture.maps.set(name, last!.maps.get(name)!);
        picture.by = job.settings;
        // What another request complained of meanwhile is still so.
        if (heard === complaints) problem.value = "";
        this.show(picture, job, since);
      } catch (error) {
        complain(error);
        // It is applying nothing any longer.
        if (this.side === 0) status.value = "";
      }
      clearTimeout(isSlow);
    }
    this.busy = false;
  }

  /** Says that the picture is not yet that of the settings. */
  private wait(job: Job): void {
    if (this.side === 0 && this.shown?.settings !== job.settings) status.value = "applying …";
  }

  private show(picture: Picture, job: Job, since: number): void {
    const before = pictures[this.side].peek();
    const isOfFrame = before?.header.frame === job.frame;
    const isChanged = !isOfFrame || this.shown?.settings !== job.settings;
    if (!isChanged) picture.header.stages_ms = before.header.stages_ms;
    else if (!isOfFrame) this.base = null;
    else if (!this.base || since - this.shownAt > PAUSE_MS) this.base = before;
    this.shown = job;
    if (isOfFrame && this.side === 0) keepColors(before, picture);
    const first = pictures[0].peek();
    if (this.side === 1 && first?.header.frame === job.frame) keepColors(first, picture);
    pictures[this.side].value = this.side === 0 ? withTracks(picture) : picture;
    // A task after the next frame begins when the picture is on the screen.
    requestAnimationFrame(() => setTimeout(() => {
      const took = performance.now() - since;
      performance.measure(`look ${this.side}`, { start: since, end: since + took });
      // More layers of the same picture are no news.
      if (!isChanged) return;
      this.shownAt = performance.now();
      if (this.side === 0) status.value = said(this.base, picture, took);
    }));
  }
}

function said(before: Picture | null, after: Picture, took: number): string {
  const count = after.header.scene.objects.length;
  const text = `${count} ${count === 1 ? "object" : "objects"}`;
  if (!before) return `${text}, shown in ${took.toFixed(0)} ms`;
  const [came, went] = cameAndWent(before, after);
  return `applied in ${took.toFixed(0)} ms: ${text}, ${came} came, ${went} went`;
}

const sides = [new Side(0), new Side(1)];

/** What was followed last. */
let followed: Followed | null = null;

/** A picture with the tracks of its frame, if they are known. */
function withTracks(picture: Picture): Picture {
  if (!followed?.tracks || followed.frame !== picture.header.frame) return picture;
  const maps = new Map(picture.maps).set("tracks", followed.tracks);
  return { ...picture, header: { ...picture.header, paths: followed.paths }, maps };
}

let pursuits = 0;

/** Follows objects to a frame, turn by turn; a newer frame or other settings end it. */
async function pursue(to: number, by: Settings): Promise<void> {
  const pursuit = ++pursuits;
  try {
    for (let next = -1; next <= to; ) {
      const seen = await follow(to, by);
      if (pursuit !== pursuits) return;
      followed = seen;
      next = seen.next;
      film.value = seen.film;
      if (next <= to) status.value = `following objects: ${next} of ${to + 1} frames`;
    }
    if (followed?.silence) complain(followed.silence);
    status.value = followed?.silence ? "nothing is said of this frame" : `${followed?.paths?.length ?? 0} objects followed to this frame`;
    const shown = pictures[0].peek();
    if (shown) pictures[0].value = withTracks(shown);
  } catch (error) {
    if (pursuit !== pursuits) return;
    complain(error);
    status.value = "";
  }
}

/** How often the page asks whether more frames came. */
const LISTENS_MS = 500;

/** Takes in the frames that came; who looks at the newest one goes on to the newest. */
async function grow(): Promise<void> {
  const before = greeting.value?.frames.length ?? 0;
  const said = await greet().catch(complain);
  if (!said || said.frames.length <= before) return;
  const isNewest = frame.value === before - 1;
  greeting.value = { ...greeting.value!, frames: said.frames };
  if (isNewest) goTo(said.frames.length - 1);
}

/** Where a tab keeps its settings until it is closed. The address has the token of the server in it. */
const KEPT = `settings of ${location.href}`;

export async function start(): Promise<void> {
  try {
    const said = await greet();
    batch(() => {
      greeting.value = said;
      settings.value = JSON.parse(sessionStorage.getItem(KEPT) ?? "null") ?? said.settings;
    });
  } catch (error) {
    complain(error);
    return;
  }
  effect(() => sessionStorage.setItem(KEPT, JSON.stringify(settings.value)));
  if (greeting.value?.grows) setInterval(() => void grow(), LISTENS_MS);
  effect(() => sides[0].want({ frame: frame.value, settings: settings.value, maps: wanted() }));
  effect(() => {
    const compared = other.value;
    sides[1].want(compared ? { frame: frame.value, settings: compared, maps: wanted() } : null);
  });
  effect(() => {
    if (isFollowing()) void pursue(frame.value, settings.value);
    else film.value = null;
  });
  effect(() => {
    const pixel = asked.value;
    if (pixel) void answer(frame.value, settings.value, pixel);
  });
}

let questions = 0;

/** The first answer at once; what would flip it follows. A newer question makes both void. */
async function answer(of: number, by: Settings, pixel: [number, number]): Promise<void> {
  const question = ++questions;
  try {
    for (const inFull of [false, true]) {
      const found = await explain(of, by, pixel, inFull);
      if (question !== questions) return;
      batch(() => {
        explained.value = { ...found, by };
        searching.value = !inFull;
        selected.value = found.explanation.object?.object ?? null;
      });
    }
  } catch (error) {
    if (question !== questions) return;
    batch(() => {
      complain(error);
      searching.value = false;
      // An answer that is about another pixel would pass for that of this one.
      if (explained.value?.explanation.pixel.join() !== pixel.join()) explained.value = null;
    });
  }
}

/** The value in force: what was set, or what the server says. */
export function valueOf(name: string): Value | undefined {
  return settings.value.set[name] ?? pictures[0].value?.header.values[name] ?? defaultOf(name);
}

export function defaultOf(name: string): Value | undefined {
  const parameter = greeting.value?.parameters.find((one) => one.name === name);
  if (!parameter) return undefined;
  if (parameter.limits) return Number(parameter.default);
  return parameter.choices.includes("true") ? parameter.default === "true" : parameter.default;
}

export function set(name: string, value: Value | undefined): void {
  const changed = { ...settings.value.set };
  if (value === undefined || value === defaultOf(name)) delete changed[name];
  else changed[name] = value;
  settings.value = { ...settings.value, set: changed };
}

export function ask(pixel: [number, number]): void {
  batch(() => {
    asked.value = pixel;
    partner.value = null;
    isPairing.value = false;
    panel.value = "explain";
  });
}

/** Asks about a second pixel too; without a first one it is the first. */
export function askWith(pixel: [number, number]): void {
  if (!asked.value) return ask(pixel);
  batch(() => {
    partner.value = pixel;
    isPairing.value = false;
    panel.value = "explain";
  });
}

export function stopAsking(): void {
  questions++;
  batch(() => {
    asked.value = null;
    partner.value = null;
    isPairing.value = false;
    explained.value = null;
    searching.value = false;
    selected.value = null;
  });
}

/** Both colour objects, by other numbers: over each other they would say nothing. */
const RIVALS: Record<string, string> = { objects: "tracks", tracks: "objects" };

export function show(name: string, share: number): void {
  const shown = new Map(opacity.value).set(name, share);
  if (share > 0 && name in RIVALS) shown.set(RIVALS[name], 0);
  opacity.value = shown;
}

/** Shows one layer, and nothing else over the picture. */
export function solo(name: string): void {
  opacity.value = new Map([[name, opacity.value.get(name) || 0.8]]);
}

export function goTo(next: number): void {
  const last = (greeting.value?.frames.length ?? 1) - 1;
  batch(() => {
    frame.value = Math.min(Math.max(next, 0), last);
    stopAsking();
  });
}
