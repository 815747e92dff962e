// Why a pixel is what it is, in the words of `objecthood explain`; what would change it can be tried.

import { useEffect, useRef } from "preact/hooks";

import { pointed } from "./picture";
import { reveal } from "./parameters";
import { RepairPanel, search } from "./repair";
import { asked, defaultOf, explained, searching, set, settings, stopAsking } from "./state";

const TRY = /--set (\S+?)=(\S+)/;
/** What the search for a flip ends with when it found none. */
const POINTS_ON = /a repair search tries all$/;

export function Explain() {
  const found = explained.value;
  const whole = useRef<HTMLElement>(null);
  // A new answer is read from its first line on.
  useEffect(() => whole.current?.closest(".side")?.scrollTo({ top: 0 }), [asked.value]);
  if (settings.value.method === "paper") return <p class="note">Only the method context can be explained.</p>;
  if (!asked.value) {
    return (
      <p class="note">
        Click on what is wrong in the picture, or press Enter on it: why is this pixel what it is, and what would change that? Shift+click
        adds a second pixel: should both be one object, or two?
      </p>
    );
  }
  return (
    <section ref={whole} aria-label="Explanation" aria-live="polite" aria-busy={searching.value}>
      <div class="bar">
        <strong>Pixel {asked.value.join(", ")}</strong>
        <span class="note">{searching.value ? "A, searching …" : "A"}</span>
        <button onClick={stopAsking}>Close</button>
      </div>
      <RepairPanel />
      {found && (
        <>
          <ul class="legend">
            <li class="own">its facet</li><li class="joined">joined to it</li><li class="apart">kept apart</li>
          </ul>
          <div class="said">{found.text.split("\n").map((line, k) => <Line key={k} text={line} />)}</div>
        </>
      )}
    </section>
  );
}

function Line({ text }: { text: string }) {
  if (/not searched/.test(text) && searching.value) return null;
  if (/\S {3,}\S/.test(text)) return <Row text={text} />;
  const change = TRY.exec(text);
  // What goes on below keeps the indent of its line.
  const indent = text.search(/\S|$/);
  const hanging = { paddingLeft: `${indent}ch`, textIndent: `-${indent}ch` };
  if (POINTS_ON.test(text)) {
    return <div class="try"><pre style={hanging}>{text}</pre><button onClick={() => void search()}>search</button></div>;
  }
  if (!change) return <pre style={hanging}>{text || " "}</pre>;
  const [, name, value] = change;
  // A long line breaks before the value, not within it.
  const [before, rest] = text.split(/(?<=--set [^\s=]+=)/);
  const kind = typeof defaultOf(name);
  const wanted = kind === "number" ? Number(value) : kind === "boolean" ? value === "true" : value;
  return (
    <div class="try">
      <pre style={hanging}>{before}<wbr />{rest}</pre>
      <button onClick={() => { set(name, wanted); reveal(name); }} title={`Set ${name} to ${value}`}>try it</button>
    </div>
  );
}

/** A line of the table of borders. Its cells stand below each other without the spaces that do so in a terminal, so that it fits. */
function Row({ text }: { text: string }) {
  const cells = text.match(/ *\S+(?: \S+)*/g) ?? [];
  const kind = /^ *\[/.test(text) ? "units" : /\d/.test(text) ? "" : "heads";
  const facet = /^ *facet (\d+)/.exec(text)?.[1];
  const point = (one: number | null) => facet !== undefined && (pointed.value = one);
  return (
    <pre
      class={`columns ${kind}`} onPointerEnter={() => point(Number(facet))} onPointerLeave={() => point(null)}
    >
      {cells.map((cell, k) => <span key={k}>{cell}</span>)}
    </pre>
  );
}
