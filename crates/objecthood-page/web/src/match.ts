// Which objects of two pictures are the same: those that share at least half of their union.

import { Picture, PixelMap } from "./wire";

/** For each object of `after` that was there before: its number then. */
function findSame(before: PixelMap, after: PixelMap): Map<number, number> {
  const sizes = [new Map<number, number>(), new Map<number, number>()];
  const common = new Map<number, number>();
  const count = (of: Map<number, number>, key: number) => of.set(key, (of.get(key) ?? 0) + 1);
  for (let i = 0; i < after.data.length; i++) {
    const [a, b] = [before.data[i], after.data[i]];
    if (a) count(sizes[0], a);
    if (b) count(sizes[1], b);
    if (a && b) count(common, a * 65536 + b);
  }
  const same = new Map<number, number>();
  for (const [pair, shared] of common) {
    const [a, b] = [Math.floor(pair / 65536), pair % 65536];
    if (2 * shared >= sizes[0].get(a)! + sizes[1].get(b)! - shared) same.set(b, a);
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
