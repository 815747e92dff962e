// Words that several parts of the page say.

/** A number of things: "1 frame", "3 frames". */
export function counted(count: number, what: string): string {
  return `${count} ${count === 1 ? what : `${what}s`}`;
}
