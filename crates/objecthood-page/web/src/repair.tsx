// What would change the answer for a pixel, or for two: a search through all parameters, whose finds come one by one.

import { batch, effect, signal } from "@preact/signals";

import { breakable, reveal } from "./parameters";
import { asked, complain, frame, isPairing, partner, pictures, set, settings, valueOf } from "./state";
import { Picture, Repair, Repairs, repair } from "./wire";

const found = signal<Repairs | null>(null);
const isSearching = signal(false);

/** The order of the rows while the pointer is among them: what is about to be clicked stays where it is. */
const held = signal<string[] | null>(null);
/** The find that is being tried, with the value before it. */
let trial: Repair | null = null;

let searches = 0;
/** The turn that the server works at: it does one after the other. */
let turn: Promise<unknown> = Promise.resolve();

/** Ends the search that is under way, and forgets what it found. */
function forget(): void {
  searches++;
  found.value = null;
  isSearching.value = false;
  held.value = null;
  trial = null;
}

/** Tries all parameters, turn by turn; a newer question ends it, and so do other settings: what is found is for those that it began with. */
export async function search(): Promise<void> {
  const pixel = asked.peek();
  if (!pixel) return;
  forget();
  const question = searches;
  const [of, by, other] = [frame.peek(), settings.peek(), partner.peek()];
  isSearching.value = true;
  try {
    for (let left = 1; left > 0 && settings.peek() === by; ) {
      await turn.catch(() => undefined);
      if (question !== searches) return;
      const asking = repair(of, by, pixel, other);
      turn = asking;
      const so = await asking;
      if (question !== searches) return;
      found.value = so;
      left = so.left;
    }
  } catch (error) {
    if (question === searches) complain(error);
  }
  if (question === searches) isSearching.value = false;
}

/** Other pixels make what was found void. Who chooses two has said what is wrong with them: the search begins. */
export function startRepairs(): void {
  effect(() => {
    const pair = asked.value && partner.value;
    forget();
    if (pair) void search();
  });
}

function objectAt(picture: Picture | null, pixel: [number, number] | null): number {
  const map = picture?.maps.get("objects");
  return map && pixel ? map.data[pixel[1] * map.width + pixel[0]] : 0;
}

/** What the search is for, as a question. */
function question(): string {
  const [a, b] = [asked.value, partner.value].map((pixel) => objectAt(pictures[0].value, pixel));
  if (!partner.value) return a ? "What would make A no object?" : "What would make A an object?";
  return a && a === b ? "What would part A and B?" : "What would make A and B one object?";
}

export function RepairPanel() {
  const [a, b] = [asked.value, partner.value].map((pixel) => objectAt(pictures[0].value, pixel));
  const named = (id: number) => (id ? `object ${id}` : "no object");
  return (
    <section class="repairs" aria-label="What would change this?">
      <h3>Is this wrong?</h3>
      <p>A is in {named(a)}{partner.value && <>, B ({partner.value.join(", ")}) in {named(b)}</>}.</p>
      <div class="bar">
        <button class="main" onClick={() => void search()} disabled={isSearching.value}>
          {found.value && trial && valueOf(trial.parameter) === trial.to ? "Search anew with these settings" : question()}
        </button>
        <button
          aria-pressed={isPairing.value} onClick={() => (isPairing.value = !isPairing.value)}
          title="To make two pixels one object, or two: click the second one (Shift+click, or key A and a click)"
        >
          {partner.value ? "Another B…" : "Ask about two pixels…"}
        </button>
      </div>
      {isPairing.value && <p class="note" role="status">Click on the pixel that should be in the same object, or in another one.</p>}
      {found.value && <Found of={found.value} />}
    </section>
  );
}

function Found({ of }: { of: Repairs }) {
  const all = of.tried + of.left;
  const order = held.value ?? of.found.map((one) => one.parameter);
  const place = (one: Repair) => (order.includes(one.parameter) ? order.indexOf(one.parameter) : order.length);
  const rows = [...of.found].sort((one, other) => place(one) - place(other));
  const count = `${of.found.length} of ${of.tried} parameters ${of.found.length === 1 ? "does" : "do"}`;
  return (
    <div>
      {rows.length > 0 && <p class="note">Each alone {of.sought}, the one that changes least else first. Trying one undoes the one before.</p>}
      <ol
        class="found" onPointerEnter={() => (held.value = rows.map((one) => one.parameter))} onPointerLeave={() => (held.value = null)}
      >
        {rows.map((one) => <Find key={one.parameter} of={one} />)}
      </ol>
      <div aria-live="polite" aria-busy={isSearching.value}>
        {isSearching.value
          ? <label class="note searched"><progress max={all} value={of.tried} /> {of.tried} of {all} parameters tried, {of.found.length || "none"} found yet</label>
          : of.left > 0 ? <p class="note">{count}; the search did not come to its end.</p>
          : rows.length > 0 ? <p class="note">{count}, with a value that was tried.</p>
          : <p>No value that was tried {of.sought}: of {all} parameters, one at a time.</p>}
      </div>
    </div>
  );
}

/** Sets a value in place of the one that was tried before. */
function tryOut(one: Repair): void {
  const last = trial;
  trial = one;
  batch(() => {
    if (last && last !== one && valueOf(last.parameter) === last.to) set(last.parameter, last.from);
    set(one.parameter, one.to);
  });
}

function Find({ of }: { of: Repair }) {
  const { parameter, from, to, others, side_effects } = of;
  const isSet = valueOf(parameter) === to;
  const turn = () => {
    if (isSet) set(parameter, from);
    else tryOut(of);
    reveal(parameter);
  };
  return (
    <li class={isSet ? "set" : ""}>
      <div><strong>{breakable(parameter)}</strong> {String(from)} → <strong>{String(to)}</strong></div>
      <div class="bar">
        <span class={others ? "note" : ""}>{side_effects}</span>
        <button onClick={turn} aria-label={`${isSet ? "undo" : "try"} ${parameter}`}>{isSet ? "undo" : "try it"}</button>
        <button class="quiet" onClick={() => reveal(parameter)} aria-label={`show slider of ${parameter}`}>show slider</button>
      </div>
    </li>
  );
}
