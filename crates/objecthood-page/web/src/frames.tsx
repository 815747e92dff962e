// Which frame is looked at.

import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { Timeline } from "./film";
import { frame, goTo, greeting, pictures } from "./state";
import { Film } from "./wire";

export const isPlaying = signal(false);
/** Frames a second when they play, where the method keeps up. */
const RATE = 10;

export function Frames({ film }: { film: Film | null | undefined }) {
  const names = greeting.value?.frames ?? [];
  const shown = pictures[0].value;
  const last = names.length - 1;
  useEffect(() => {
    // The next frame waits until this one is there.
    if (!isPlaying.value || shown?.header.frame !== frame.value) return;
    const next = setTimeout(() => (frame.value >= last ? (isPlaying.value = false) : goTo(frame.value + 1)), 1000 / RATE);
    return () => clearTimeout(next);
  }, [isPlaying.value, shown, frame.value, last]);
  if (names.length < 2) return null;
  return (
    <div class="frames" role="group" aria-label="Frames">
      <button onClick={() => goTo(frame.value - 1)} disabled={frame.value === 0} title="Frame before (key ,)" aria-label="Frame before">◀</button>
      <button onClick={play} title="Play (key P)" aria-label={isPlaying.value ? "Stop" : "Play"}>{isPlaying.value ? "■" : "▶"}</button>
      <button onClick={() => goTo(frame.value + 1)} disabled={frame.value === last} title="Next frame (key .)" aria-label="Next frame">▶|</button>
      <input
        id="scrubber" type="range" min="0" max={last} value={frame.value} aria-label="Frame" aria-valuetext={names[frame.value]}
        onInput={(e) => goTo(e.currentTarget.valueAsNumber)}
      />
      <span title={names[frame.value]}>{frame.value + 1} of {names.length}</span>
      {film && <Timeline film={film} />}
    </div>
  );
}

export function play(): void {
  const last = (greeting.value?.frames.length ?? 1) - 1;
  if (!isPlaying.value && frame.value >= last) goTo(0);
  isPlaying.value = !isPlaying.value;
}
