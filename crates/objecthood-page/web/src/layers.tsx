// Which layers lie over the picture, and how opaque they are.

import { LAYERS } from "./paint";
import { available, greeting, opacity, pictures, show, solo } from "./state";

/** What a layer shows with when it is switched on. */
const SWITCHED_ON = 0.6;

export function Layers() {
  const known = available.value;
  return (
    <div class="layers" role="group" aria-label="Layers">
      {LAYERS.map(({ name, title, meaning }, k) => {
        const hasTruth = name !== "truth" || pictures[0].value?.header.truth;
        const isHeld = known ? known.has(name) : name !== "tracks" || (greeting.value?.frames.length ?? 0) > 1;
        if (!isHeld || !hasTruth) return null;
        const share = opacity.value.get(name) ?? 0;
        return (
          <div key={name} class={share > 0 ? "layer on" : "layer"}>
            <button
              aria-pressed={share > 0} title={`${meaning}\nKey ${key(k)}; with Shift it alone`}
              onClick={(e) => (e.shiftKey ? solo(name) : toggle(name))}
            >
              <kbd>{key(k)}</kbd> {title}
            </button>
            {share > 0 && (
              <input
                type="range" min="0.05" max="1" step="0.05" value={share} aria-label={`Opacity of ${title}`}
                onInput={(e) => show(name, e.currentTarget.valueAsNumber)}
              />
            )}
          </div>
        );
      })}
    </div>
  );
}

/** 1 to 9, then 0, - and =, as on the keyboard. */
const KEYS = "1234567890-=";

function key(k: number): string {
  return KEYS[k];
}

export function toggle(name: string): void {
  show(name, (opacity.value.get(name) ?? 0) > 0 ? 0 : SWITCHED_ON);
}

/** The layer behind a key. */
export function layerOf(pressed: string): string | undefined {
  return LAYERS[KEYS.indexOf(pressed)]?.name;
}
