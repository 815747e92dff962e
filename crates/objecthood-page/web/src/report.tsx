// A report: frames in a file, shown as the live page shows them.

import { effect, signal } from "@preact/signals";
import { render } from "preact";

import { onKeys } from "./keys";
import { Layers } from "./layers";
import { turnLight } from "./light";
import { Story } from "./film";
import { Frames, play } from "./frames";
import { Objects } from "./objects";
import { endQuestion, PictureView, zoomBy, zoomOut } from "./picture";
import { rangeOf } from "./range";
import { SpaceView } from "./space";
import { available, frame, goTo, greeting, isLive, opacity, pictures, problem, settings, view } from "./state";
import { all, Findings, Row, stored } from "./stored";
import { next, Tabs } from "./tabs";
import { counted } from "./words";

const VIEWS = { picture: "Picture", space: "In space" } as const;
const LEFT = { figures: "Figures", story: "Story", frames: "Frames", parameters: "Parameters", times: "Times" } as const;
type Left = keyof typeof LEFT;
const left = signal<Left>("frames");
const rows = signal<Row[]>([]);
const findings = signal<Findings>({ html: "", plots: [], film: null });

/** The tabs that have something to show. */
function leftTabs(): Partial<Record<Left, string>> {
  const { figures, story, frames, parameters, times } = LEFT;
  const { html, film } = findings.value;
  return {
    ...(html && { figures }),
    ...(film && { story }),
    ...(rows.value.length > 0 && { frames, parameters, times }),
  };
}

type Column = "place" | "objects" | "correct" | "method_ms";
const order = signal<{ by: Column; falls: boolean }>({ by: "place", falls: false });

/** What the columns are called. Of a video the tracks that a frame sees are its objects. */
function titles(): Record<Column, string> {
  return { place: "frame", objects: findings.value.film ? "tracks" : "objects", correct: "correct", method_ms: "ms" };
}

/** What was found in all frames. Objects of frames that do not belong together are counted in each; of a video, tracks are. */
function found(): string {
  const { film } = findings.value;
  if (film) return counted(Object.keys(film.lives).length, "track");
  const objects = counted(rows.value.reduce((sum, row) => sum + row.objects, 0), "object");
  return rows.value.length === 1 ? objects : `${objects} over all frames`;
}

function Summary() {
  const sum = (of: (row: Row) => number) => rows.value.reduce((total, row) => total + of(row), 0);
  const judged = rows.value.filter(({ correct }) => correct);
  const times = rows.value.map((row) => row.method_ms).sort((a, b) => a - b);
  return (
    <p class="score">
      {counted(rows.value.length, "frame")}, {found()}
      {judged.length > 0 && `, ${sum(({ correct }) => correct?.[0] ?? 0)} of ${sum(({ correct }) => correct?.[1] ?? 0)} correct`}
      {`, median ${(times[Math.floor(times.length / 2)] ?? 0).toFixed(0)} ms a frame for the method`}
    </p>
  );
}

function FrameList() {
  const { by, falls } = order.value;
  const names = titles();
  const columns = (Object.keys(names) as Column[]).filter((column) => column !== "correct" || rows.value.some(({ correct }) => correct));
  const value = (k: number) => {
    const { objects, correct, method_ms } = rows.value[k];
    return by === "place" ? k : by === "objects" ? objects : by === "method_ms" ? method_ms : correct ? correct[0] / correct[1] : 2;
  };
  const sorted = rows.value.map((_, k) => k).sort((a, b) => (falls ? -1 : 1) * (value(a) - value(b)) || a - b);
  return (
    <table class="objects list">
      <thead>
        <tr>
          {columns.map((column) => (
            <th key={column} scope="col" aria-sort={by === column ? (falls ? "descending" : "ascending") : "none"}>
              <button class="quiet" onClick={() => (order.value = { by: column, falls: by === column && !falls })}>
                {names[column]}{by === column ? (falls ? " ▼" : " ▲") : ""}
              </button>
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {sorted.map((k) => {
          const { name, objects, correct, method_ms, thumbnail } = rows.value[k];
          return (
            <tr key={k} class={k === frame.value ? "chosen" : ""} onClick={() => goTo(k)}>
              <td class="named">
                <button class="tile" onClick={() => goTo(k)} aria-current={k === frame.value}>
                  <img src={`data:image/jpeg;base64,${thumbnail}`} alt="" width={104} loading="lazy" />
                  <span>{name.split("/").at(-1)}</span>
                </button>
              </td>
              <td>{objects}</td>
              {columns.includes("correct") && <td>{correct ? correct.join("/") : ""}</td>}
              <td>{method_ms.toFixed(0)}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function Parameters() {
  const values = pictures[0].value?.header.values ?? {};
  const { method, set } = settings.value;
  return (
    <>
      <p>Method {method}. {Object.keys(set).length} parameters are not at their defaults.</p>
      {greeting.value?.parameters.filter(({ stages }) => stages[method === "context" ? 0 : 1]).map((one) => (
        <div key={one.name} class={one.name in set ? "parameter changed" : "parameter"}>
          <strong>{one.name}</strong> = {String(values[one.name] ?? set[one.name] ?? one.default)}
          <p class="meaning">{one.meaning} <span class="range">{rangeOf(one)}</span></p>
        </div>
      ))}
    </>
  );
}

function Figures() {
  const { html, plots } = findings.value;
  return (
    <>
      <div class="figures" dangerouslySetInnerHTML={{ __html: html }} />
      {plots.map((address, k) => <img key={k} class="plot" src={address} alt="Plot of the figures" />)}
    </>
  );
}

function Left() {
  switch (left.value) {
    case "figures": return <Figures />;
    case "story": return <Story film={findings.value.film!} />;
    case "frames": return <FrameList />;
    case "parameters": return <Parameters />;
    case "times": return <Times />;
  }
}

function Times() {
  const laps = pictures[0].value?.header.stages_ms ?? [];
  const longest = Math.max(...laps.map(([, ms]) => ms), 1e-9);
  return (
    <table class="objects">
      <tbody>
        {laps.map(([stage, ms]) => (
          <tr key={stage}><td>{stage}</td><td>{ms.toFixed(1)} ms</td><td><meter min={0} max={longest} value={ms} /></td></tr>
        ))}
      </tbody>
    </table>
  );
}

function ReportPage() {
  const name = greeting.value?.frames[frame.value] ?? "";
  const { film } = findings.value;
  if (rows.value.length === 0) {
    return (
      <div class="sheet-of-figures">
        <h1>objecthood</h1>
        <Figures />
      </div>
    );
  }
  return (
    <div class="page">
      <header class="top">
        <h1>objecthood</h1>
        <span class="file" title={name}><bdi>{name}</bdi></span>
        <span class="status">version {greeting.value?.version}</span>
        <button onClick={turnLight} title="Dark or light (key L)">◐</button>
      </header>
      <div class="said-first">{problem.value && <p class="problem" role="alert">{problem.value}</p>}</div>
      <main class="middle">
        <Tabs of={view} names={VIEWS} label="View" />
        {view.value === "space" ? <SpaceView /> : <PictureView />}
        <Layers />
        <Frames film={film} />
      </main>
      <section class="parameters" aria-label="Frames">
        <Tabs of={left} names={leftTabs()} label="Left" />
        <Summary />
        <div class="groups"><Left /></div>
      </section>
      <aside class="side"><Objects /></aside>
    </div>
  );
}

/** Keeps the picture that of the frame. */
function showFrame(number: number): void {
  stored(number).then(
    (picture) => {
      if (number !== frame.value) return;
      available.value = new Set(picture.maps.keys());
      pictures[0].value = picture;
    },
    (error) => (problem.value = `frame ${number} cannot be unpacked: ${error}`),
  );
}

export function startReport(): void {
  const held = all();
  isLive.value = false;
  greeting.value = held.greeting;
  settings.value = held.greeting.settings;
  rows.value = held.rows;
  findings.value = held.findings;
  left.value = (Object.keys(leftTabs()) as Left[])[0] ?? "frames";
  if (held.findings.film) opacity.value = new Map([["tracks", 0.45]]);
  onKeys({
    ",": () => goTo(frame.value - 1),
    ".": () => goTo(frame.value + 1),
    p: play,
    v: () => next(view, VIEWS),
    l: turnLight,
    z: zoomOut,
    "+": () => zoomBy(1.25),
    Escape: endQuestion,
  });
  render(<ReportPage />, document.getElementById("page")!);
  if (held.rows.length > 0) effect(() => showFrame(frame.value));
}
