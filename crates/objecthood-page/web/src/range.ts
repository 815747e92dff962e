// The range of a parameter in words.

import { Parameter } from "./wire";

/** What a parameter may be, and its default. A unit that begins with a digit, as 1/m, would read as one more number. */
export function rangeOf({ limits, range, unit, default: usual }: Parameter): string {
  const its = /^\d/.test(unit) ? `(${unit})` : unit;
  return `${limits ? `${limits.join(" to ")} ${its}` : range}, default ${usual}`;
}
