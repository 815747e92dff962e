// The frames that a report holds.

import { Film, Greeting, Picture, PixelMap, unpack } from "./wire";

/** What the list of frames says of one. */
export interface Row {
  name: string;
  objects: number;
  correct: [number, number] | null;
  /** How long the stages of the method took together. */
  method_ms: number;
  thumbnail: string;
}

/** What a report says beside its frames. */
export interface Findings {
  html: string;
  plots: string[];
  film: Film | null;
}

interface All {
  greeting: Greeting;
  rows: Row[];
  findings: Findings;
}

/** Whether this document is a report. */
export function holdsFrames(): boolean {
  return document.getElementById("all") !== null;
}

export function all(): All {
  return JSON.parse(document.getElementById("all")!.textContent!);
}

/** Unpacks a frame. */
export async function stored(number: number): Promise<Picture> {
  const text = document.getElementsByClassName("frame")[number].textContent!;
  const inflated = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  const picture = unpack(await new Response(inflated).arrayBuffer());
  const { width_px: width, height_px: height } = picture.header.scene.image;
  for (const { name, kind } of picture.header.maps) {
    const map = picture.maps.get(name)!;
    if (kind === "jpeg") picture.maps.set(name, await decoded(map, width, height));
    else if (!name.endsWith(".colors") && map.width !== width) picture.maps.set(name, enlarged(map, kind === "rgb" ? 3 : 1, width, height));
  }
  return picture;
}

function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
}

async function decoded({ data }: PixelMap, width: number, height: number): Promise<PixelMap> {
  const image = await createImageBitmap(new Blob([data as Uint8Array<ArrayBuffer>], { type: "image/jpeg" }));
  const context = new OffscreenCanvas(width, height).getContext("2d")!;
  context.drawImage(image, 0, 0, width, height);
  const pixels = context.getImageData(0, 0, width, height).data;
  const rgb = new Uint8Array(3 * width * height);
  for (let i = 0, o = 0; o < rgb.length; i += 4, o += 3) rgb.set([pixels[i], pixels[i + 1], pixels[i + 2]], o);
  return { width, height, unit_m: null, data: rgb };
}

/** Repeats every pixel of a map of half the size. */
function enlarged(map: PixelMap, channels: number, width: number, height: number): PixelMap {
  const Kind = map.data.constructor as new (length: number) => typeof map.data;
  const data = new Kind(channels * width * height);
  for (let v = 0, o = 0; v < height; v++) {
    for (let u = 0; u < width; u++) {
      const from = channels * ((v >> 1) * map.width + (u >> 1));
      for (let c = 0; c < channels; c++) data[o++] = map.data[from + c];
    }
  }
  return { width, height, unit_m: map.unit_m, data };
}
