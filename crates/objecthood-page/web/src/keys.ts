// Keys for everything.

import { layerOf, toggle } from "./layers";
import { solo } from "./state";

/** Letters belong to whoever is typing. */
function isTyping(target: EventTarget | null): boolean {
  return target instanceof HTMLElement
    && (target.matches("input:not([type=range], [type=checkbox]), textarea, select") || target.closest("dialog") !== null);
}

/** Lets keys do things; digits switch layers. */
export function onKeys(does: Record<string, () => void>): void {
  addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || isTyping(e.target)) return;
    const digit = /^Digit(\d)$/.exec(e.code)?.[1];
    const layer = layerOf(digit ?? e.key);
    const act = does[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (layer) (e.shiftKey ? solo : toggle)(layer);
    else if (act) act();
    else return;
    e.preventDefault();
  });
}
