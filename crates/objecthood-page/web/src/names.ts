// Where the facets that an explanation names are in the picture.

import { Explanation, PixelMap } from "./wire";

/** Borders that the text lists, the longest first. */
const NAMED = 16;
/** A smaller facet would vanish below its number; the row of the table points it out. */
const LEAST_PX = 150;

let last: { explanation: Explanation; filled: PixelMap; names: [number, [number, number]][] } | null = null;

/** The facet of an explanation and those that it borders on, each with the one of its pixels that is nearest to its middle. Structure has no number. */
export function namesOf(explanation: Explanation, filled: PixelMap): [number, [number, number]][] {
  if (last?.explanation === explanation && last.filled === filled) return last.names;
  const partners = explanation.borders.slice(0, NAMED).filter((one) => one.structure_plane === undefined);
  const facets = new Set(partners.map((one) => one.facet));
  if (explanation.facet && explanation.facet.structure_plane === undefined) facets.add(explanation.facet.facet);
  const pixels = new Map<number, number[]>();
  for (let i = 0; i < filled.data.length; i++) {
    const facet = filled.data[i] - 1;
    if (!facets.has(facet)) continue;
    const own = pixels.get(facet);
    if (own) own.push(i);
    else pixels.set(facet, [i]);
  }
  const names = [...pixels].filter(([, own]) => own.length >= LEAST_PX).map(([facet, own]): [number, [number, number]] => [facet, middle(own, filled.width)]);
  last = { explanation, filled, names };
  return names;
}

function middle(pixels: number[], width: number): [number, number] {
  const at = (i: number): [number, number] => [i % width, Math.floor(i / width)];
  const [u, v] = [0, 1].map((k) => pixels.reduce((sum, i) => sum + at(i)[k], 0) / pixels.length);
  const off = (i: number) => (at(i)[0] - u) ** 2 + (at(i)[1] - v) ** 2;
  return at(pixels.reduce((best, i) => (off(i) < off(best) ? i : best)));
}
