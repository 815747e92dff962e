// Reads the label images that `objecthood segment` writes: grey, 16 bits, not interlaced.
import { readFile } from "node:fs/promises";
import { inflateSync } from "node:zlib";

/** The labels of a file, row by row. */
export async function labelsOf(path) {
  const file = await readFile(path);
  const [width, height, depth, kind] = [file.readUInt32BE(16), file.readUInt32BE(20), file[24], file[25]];
  if (depth !== 16 || kind !== 0) throw new Error(`${path} is no label image`);
  const parts = [];
  for (let at = 8; at < file.length; at += 12 + file.readUInt32BE(at)) {
    if (file.toString("latin1", at + 4, at + 8) === "IDAT") parts.push(file.subarray(at + 8, at + 8 + file.readUInt32BE(at)));
  }
  const rows = inflateSync(Buffer.concat(parts));
  const stride = 2 * width;
  let above = new Uint8Array(stride);
  const labels = new Uint16Array(width * height);
  for (let v = 0; v < height; v++) {
    const filter = rows[v * (stride + 1)];
    const row = Uint8Array.from(rows.subarray(v * (stride + 1) + 1, (v + 1) * (stride + 1)));
    for (let i = 0; i < stride; i++) {
      const [left, up, corner] = [i > 1 ? row[i - 2] : 0, above[i], i > 1 ? above[i - 2] : 0];
      row[i] += [0, left, up, (left + up) >> 1, filter === 4 ? paeth(left, up, corner) : 0][filter];
    }
    for (let u = 0; u < width; u++) labels[v * width + u] = 256 * row[2 * u] + row[2 * u + 1];
    above = row;
  }
  return labels;
}

function paeth(left, up, corner) {
  const guess = left + up - corner;
  const [a, b, c] = [left, up, corner].map((x) => Math.abs(guess - x));
  return a <= b && a <= c ? left : b <= c ? up : corner;
}
