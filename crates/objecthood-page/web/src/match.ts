// Which objects of two pictures are the same: those that share at least half of their union.

import { Picture, PixelMap } from "./wire";

/** For each object of `after` that was there before: its number then. */
function findSame(before: PixelMap, after: PixelMap): Map<number, number> {
  const [sizesBefore, sizesAfter] = [new Uint32Array(65536), new Uint32Array(65536)];
  const common = new Map<number, number>();
  const length = after.data.length;
  // Labels come in runs: this stands between a change and its picture.
  for (let start = 0, end = 0; start < length; start = end) {
    const [a, b] = [before.data[start], after.data[start]];
    while (end < length && before.data[end] === a && after.data[end] === b) end++;
    sizesBefore[a] += end - start;
    sizesAfter[b] += end - start;
    if (a && b) common.set(a * 65536 + b, (common.get(a * 65536 + b) ?? 0) + end - start);
  }
  const same = new Map<number, number>();
  for (const [pair, shared] of common) {
    const [a, b] = [Math.floor(pair / 65536), pair % 65536];
    if (2 * shared >= sizesBefore[a] + sizesAfter[b] - shared) same.set(b, a);
  }
  return same;
}

/** How many objects came and went between two pictures of a frame. */
export function cameAndWent(before: Picture, after: Picture): [number, number] {
  const [a, b] = [before.maps.get("objects"), after.maps.get("objects")];
  const stayed = a && b ? findSame(a, b).size : 0;
  return [after.header.scene.objects.length - stayed, before.header.scene.objects.length - stayed];
}

/** Gives each object of a picture the colour that it had in another picture of the frame; the others get colours that are free. */
export function keepColors(before: Picture, after: Picture): void {
  const [a, b] = [before.maps.get("objects"), after.maps.get("objects")];
  if (!a || !b) return;
  const same = findSame(a, b);
  const taken = new Set([...same.values()].map((then) => before.colors.get(then) ?? then));
  let free = 1;
  for (const { id } of after.header.scene.objects) {
    const then = same.get(id);
    if (then !== undefined) {
      after.colors.set(id, before.colors.get(then) ?? then);
      continue;
    }
    while (taken.has(free)) free++;
    taken.add(free);
    after.colors.set(id, free);
  }
}
