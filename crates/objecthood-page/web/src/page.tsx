// The live page.

import { signal } from "@preact/signals";
import { render } from "preact";

import { Elsewhere, isOpen } from "./elsewhere";
import { Explain } from "./explain";
import { Story } from "./film";
import { Frames, play } from "./frames";
import { onKeys } from "./keys";
import { Layers } from "./layers";
import { turnLight } from "./light";
import { Objects } from "./objects";
import { Parameters } from "./parameters";
import { endQuestion, PictureView, Swipe, zoomBy, zoomOut } from "./picture";
import { startRepairs, search } from "./repair";
import { Sheet } from "./sheet";
import { SpaceView } from "./space";
import { next, Tabs } from "./tabs";
import { bye } from "./wire";
import { asked, film, frame, goTo, greeting, other, isPairing, panel, problem, settings, start, status, view } from "./state";

const VIEWS = { picture: "Picture", space: "In space", sheet: "Many frames" } as const;
const PANELS = { objects: "Objects", explain: "Why?" } as const;
/** Those of a video. */
const PANELS_OF_FILM = { ...PANELS, story: "Story" } as const;
const isHelping = signal(false);

function compare(): void {
  other.value = other.value ? null : settings.value;
}

function swap(): void {
  const before = other.value;
  if (before) [other.value, settings.value] = [settings.value, before];
}

function Header() {
  const name = greeting.value?.frames[frame.value] ?? "";
  return (
    <header class="top">
      <h1>objecthood</h1>
      <span class="file" title={name}><bdi>{name}</bdi></span>
      <output class="status" aria-live="polite">{status.value}</output>
      <button aria-pressed={other.value !== null} onClick={compare} title="Keep these settings as B and compare with them (key B)">A | B</button>
      {other.value && <button onClick={swap} title="Exchange A and B (key X)">Swap</button>}
      <button class="main" onClick={() => (isOpen.value = true)} title="As TOML, command line, Python; save and load (key C)">Copy settings</button>
      <button onClick={turnLight} title="Dark or light (key L)">◐</button>
      <button onClick={() => (isHelping.value = !isHelping.value)} aria-pressed={isHelping.value} title="Keys (key ?)">Help</button>
    </header>
  );
}

const KEYS = [
  ["1 … 9 0 - =", "layers; with Shift one alone"], ["/", "find a parameter"], [", .", "frame before, next"], ["P", "play"],
  ["V", "picture, space, many frames"], ["O", "objects, why"], ["B X", "compare with B, exchange"], ["C", "copy settings"], ["L", "dark or light"],
  ["+ Z", "enlarge, fit"], ["arrows, Enter on the picture", "move the cross, explain"], ["A, W", "a second pixel, what would change it"], ["Escape", "close this help, end an explanation"],
];

function Help() {
  if (!isHelping.value) return null;
  return (
    <aside class="help" aria-label="Help">
      <p>
        A parameter changes a stage and all after it. Click on what is wrong in the picture: the answer says what decided, and a search
        tries every parameter, which one would change it. Shift+click on a second pixel: should both be one object, or two?
      </p>
      <p><a href="licences" target="_blank">Licences of what this page is made with</a></p>
      <dl>{KEYS.map(([key, does]) => <div key={key}><dt><kbd>{key}</kbd></dt><dd>{does}</dd></div>)}</dl>
    </aside>
  );
}

function Page() {
  return (
    <div class="page">
      <Header />
      <div class="said-first">
        {problem.value && <p class="problem" role="alert">{problem.value}</p>}
        <Help />
      </div>
      <main class="middle">
        <div class="bar">
          <Tabs of={view} names={VIEWS} label="View" />
          <Swipe />
        </div>
        {view.value === "picture" ? <PictureView /> : view.value === "space" ? <SpaceView /> : <Sheet />}
        <Layers />
        <Frames film={film.value} />
      </main>
      <Parameters />
      <aside class="side">
        <Tabs of={panel} names={film.value ? PANELS_OF_FILM : PANELS} label="Side" />
        {panel.value === "explain" ? <Explain /> : panel.value === "story" && film.value ? <Story film={film.value} /> : <Objects />}
      </aside>
      <Elsewhere />
    </div>
  );
}

const DOES: Record<string, () => void> = {
  ",": () => goTo(frame.value - 1),
  ".": () => goTo(frame.value + 1),
  p: play,
  v: () => next(view, VIEWS),
  o: () => next(panel, film.value ? PANELS_OF_FILM : PANELS),
  b: compare,
  x: swap,
  l: turnLight,
  c: () => (isOpen.value = true),
  a: () => (isPairing.value = asked.value !== null && !isPairing.value),
  w: () => void search(),
  z: zoomOut,
  "+": () => zoomBy(1.25),
  "?": () => (isHelping.value = !isHelping.value),
  Escape: () => (isHelping.value ? (isHelping.value = false) : endQuestion()),
  "/": () => document.getElementById("sought")?.focus(),
};

export function startPage(): void {
  onKeys(DOES);
  render(<Page />, document.getElementById("page")!);
  addEventListener("pagehide", bye);
  startRepairs();
  void start();
}
