// The live page.

import { signal } from "@preact/signals";
import { render } from "preact";

import { Elsewhere, isOpen } from "./elsewhere";
import { Explain } from "./explain";
import { Frames, play } from "./frames";
import { layerOf, Layers, toggle } from "./layers";
import { Objects } from "./objects";
import { Parameters } from "./parameters";
import { PictureView, Swipe, zoomBy, zoomOut } from "./picture";
import { Sheet } from "./sheet";
import { SpaceView } from "./space";
import { frame, goTo, greeting, other, panel, problem, settings, solo, start, status, stopAsking, view } from "./state";

const VIEWS = { picture: "Picture", space: "In space", sheet: "Many frames" } as const;
const PANELS = { objects: "Objects", explain: "Why?" } as const;
const isHelping = signal(false);

function Tabs<T extends string>({ of, names, label }: { of: { value: T }; names: Record<T, string>; label: string }) {
  return (
    <div class="tabs" role="tablist" aria-label={label}>
      {(Object.keys(names) as T[]).map((name) => (
        <button key={name} role="tab" aria-selected={of.value === name} onClick={() => (of.value = name)}>{names[name]}</button>
      ))}
    </div>
  );
}

function compare(): void {
  other.value = other.value ? null : settings.value;
}

function swap(): void {
  const before = other.value;
  if (before) [other.value, settings.value] = [settings.value, before];
}

function turnLight(): void {
  const root = document.documentElement;
  const isDark = getComputedStyle(root).colorScheme === "dark" || (!root.dataset.theme && matchMedia("(prefers-color-scheme: dark)").matches);
  root.dataset.theme = isDark ? "light" : "dark";
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
  ["1 … 9 0 -", "layers; with Shift one alone"], ["/", "find a parameter"], [", .", "frame before, next"], ["P", "play"],
  ["V", "picture, space, many frames"], ["O", "objects, why"], ["B X", "compare with B, exchange"], ["C", "copy settings"], ["L", "dark or light"],
  ["+ Z", "enlarge, fit"], ["arrows, Enter on the picture", "move the cross, explain"], ["Escape", "end an explanation"],
];

function Help() {
  if (!isHelping.value) return null;
  return (
    <aside class="help" aria-label="Help">
      <p>
        A parameter changes a stage and all after it. Click on what is wrong in the picture: the answer names the parameters that
        decided, and what would change it.
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
        <Frames />
      </main>
      <Parameters />
      <aside class="side">
        <Tabs of={panel} names={PANELS} label="Side" />
        {panel.value === "objects" ? <Objects /> : <Explain />}
      </aside>
      <Elsewhere />
    </div>
  );
}

function next<T extends string>(of: { value: T }, names: Record<T, string>): void {
  const all = Object.keys(names) as T[];
  of.value = all[(all.indexOf(of.value) + 1) % all.length];
}

const DOES: Record<string, () => void> = {
  ",": () => goTo(frame.value - 1),
  ".": () => goTo(frame.value + 1),
  p: play,
  v: () => next(view, VIEWS),
  o: () => next(panel, PANELS),
  b: compare,
  x: swap,
  l: turnLight,
  c: () => (isOpen.value = true),
  z: zoomOut,
  "+": () => zoomBy(1.25),
  "?": () => (isHelping.value = !isHelping.value),
  Escape: stopAsking,
  "/": () => document.getElementById("sought")?.focus(),
};

/** Letters belong to whoever is typing. */
function isTyping(target: EventTarget | null): boolean {
  return target instanceof HTMLElement
    && (target.matches("input:not([type=range], [type=checkbox]), textarea, select") || target.closest("dialog") !== null);
}

addEventListener("keydown", (e) => {
  if (e.ctrlKey || e.metaKey || e.altKey || isTyping(e.target)) return;
  const digit = /^Digit(\d)$/.exec(e.code)?.[1];
  const layer = layerOf(digit ?? e.key);
  const does = DOES[e.key.length === 1 ? e.key.toLowerCase() : e.key];
  if (layer) (e.shiftKey ? solo : toggle)(layer);
  else if (does) does();
  else return;
  e.preventDefault();
});

render(<Page />, document.getElementById("page")!);
void start();
