// What would change the answer for a pixel, or for two: a search through all parameters, whose finds come one by one.

import { effect, signal } from "@preact/signals";

import { breakable, reveal } from "./parameters";
import { asked, frame, isPairing, partner, pictures, problem, set, settings, valueOf } from "./state";
import { Picture, Repair, Repairs, repair } from "./wire";

const found = signal<Repairs | null>(null);
const isSearching = signal(false);

let searches = 0;

/** Ends the search that is under way, and forgets what it found. */
function forget(): void {
  searches++;
  found.value = null;
  isSearching.value = false;
}

/** Tries all parameters, turn by turn; a newer question ends it. */
export async function search(): Promise<void> {
  const pixel = asked.peek();
  if (!pixel) return;
  forget();
  const question = searches;
  const [of, by, other] = [frame.peek(), settings.peek(), partner.peek()];
  isSearching.value = true;
  try {
    for (let left = 1; left > 0; ) {
      const so = await repair(of, by, pixel, other);
      if (question !== searches) return;
      found.value = so;
      left = so.left;
    }
  } catch (error) {
    if (question === searches) problem.value = error instanceof Error ? error.message : String(error);
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
        <button class="main" onClick={() => void search()} disabled={isSearching.value}>{question()}</button>
        <button
          aria-pressed={isPairing.value} onClick={() => (isPairing.value = !isPairing.value)}
          title="To make two pixels one object, or two: click the second one (Shift+click, or key A and a click)"
        >
          {partner.value ? "Another B…" : "and another pixel…"}
        </button>
      </div>
      {isPairing.value && <p class="note" role="status">Click on the pixel that should be in the same object, or in another one.</p>}
      {found.value && <Found of={found.value} />}
    </section>
  );
}

function Found({ of }: { of: Repairs }) {
  const all = of.tried + of.left;
  return (
    <div aria-live="polite" aria-busy={isSearching.value}>
      {isSearching.value && <label class="note searched"><progress max={all} value={of.tried} /> {of.tried} of {all} parameters tried</label>}
      {of.found.length > 0 && <p class="note">Each alone {of.sought}, the one that changes least else first:</p>}
      <ol class="found">{of.found.map((one) => <Find key={one.parameter} of={one} />)}</ol>
      {!isSearching.value && of.found.length === 0 && <p>None of {all} parameters {of.sought} alone.</p>}
      {!isSearching.value && of.found.length > 0 && <p class="note">{of.found.length} of {all} parameters do, all others do not.</p>}
    </div>
  );
}

function Find({ of: { parameter, from, to, others, side_effects } }: { of: Repair }) {
  const isSet = valueOf(parameter) === to;
  const turn = () => {
    set(parameter, isSet ? from : to);
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
