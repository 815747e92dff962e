// Why a pixel is what it is, in the words of `objecthood explain`; what would change it can be tried.

import { useEffect, useRef } from "preact/hooks";

import { asked, defaultOf, explained, searching, set, settings, stopAsking } from "./state";

const TRY = /--set (\S+?)=(\S+)/;

export function Explain() {
  const found = explained.value;
  const whole = useRef<HTMLElement>(null);
  // A new answer is read from its first line on.
  useEffect(() => whole.current?.closest(".side")?.scrollTo({ top: 0 }), [asked.value]);
  if (settings.value.method === "paper") return <p class="note">Only the method context can be explained.</p>;
  if (!asked.value) {
    return <p class="note">Click on the picture, or press Enter on it: why is this pixel an object, and what would change that?</p>;
  }
  return (
    <section ref={whole} aria-label="Explanation" aria-live="polite" aria-busy={searching.value}>
      <div class="bar">
        <strong>Pixel {asked.value.join(", ")}</strong>
        <span class="note">{searching.value ? "searching what would change it …" : ""}</span>
        <button onClick={stopAsking}>Close</button>
      </div>
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
  if (!change) return <pre style={hanging}>{text || " "}</pre>;
  const [, name, value] = change;
  // A long line breaks before the value, not within it.
  const [before, rest] = text.split(/(?<=--set [^\s=]+=)/);
  const number = typeof defaultOf(name) === "number" ? Number(value) : value;
  return (
    <div class="try">
      <pre style={hanging}>{before}<wbr />{rest}</pre>
      <button onClick={() => set(name, number)} title={`Set ${name} to ${value}`}>try it</button>
    </div>
  );
}

/** A line of the table of borders. Its cells stand below each other without the spaces that do so in a terminal, so that it fits. */
function Row({ text }: { text: string }) {
  const cells = text.match(/ *\S+(?: \S+)*/g) ?? [];
  const kind = /^ *\[/.test(text) ? "units" : /\d/.test(text) ? "" : "heads";
  return <pre class={`columns ${kind}`}>{cells.map((cell, k) => <span key={k}>{cell}</span>)}</pre>;
}
