// The same settings on many frames at once.

import { batch, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { compose, UNMARKED } from "./paint";
import { frame, goTo, greeting, isFollowing, mapsShown, settings, unfollowed, view } from "./state";
import { look, Picture, wordsOf } from "./wire";
import { counted } from "./words";

const COUNTS = [4, 9, 16, 25];
const count = signal(9);
/** The picture of each frame, or why it has none. */
const tiles = signal(new Map<number, Picture | string>());

/** Frames that are spread over all of them. */
function chosen(): number[] {
  const all = greeting.value?.frames.length ?? 0;
  const most = Math.min(count.value, all);
  return Array.from({ length: most }, (_, k) => Math.floor((k * all) / most));
}

export function Sheet() {
  const frames = chosen();
  const [by, maps] = [settings.value, mapsShown()];
  useEffect(() => {
    let isOver = false;
    const load = async () => {
      for (const number of frames) {
        if (isOver) return;
        const tile = await look(2, number, by, maps).catch(wordsOf);
        if (!isOver) tiles.value = new Map(tiles.value).set(number, tile);
      }
    };
    const soon = setTimeout(load, 150);
    return () => {
      isOver = true;
      clearTimeout(soon);
    };
  }, [by, maps.join(), frames.join()]);
  useEffect(() => () => void (tiles.value = new Map()), []);
  return (
    <div class="sheet">
      <div class="bar">
        <label>
          Frames{" "}
          <select value={count.value} onChange={(e) => (count.value = Number(e.currentTarget.value))}>
            {COUNTS.map((n) => <option key={n} value={n}>{n}</option>)}
          </select>
        </label>
        <Total pictures={frames.map((number) => tiles.value.get(number)).filter((one) => typeof one === "object")} of={frames.length} />
        {isFollowing() && <span class="note">Objects are not followed here: they stand in for tracks.</span>}
      </div>
      <div class="tiles">{frames.map((number) => <Tile key={number} number={number} />)}</div>
    </div>
  );
}

/** What the frames that were looked at have together. */
function Total({ pictures, of }: { pictures: Picture[]; of: number }) {
  if (pictures.length === 0) return null;
  const found = pictures.reduce((sum, { header }) => sum + header.scene.objects.length, 0);
  const judged = pictures.filter(({ header }) => header.truth);
  const correct = judged.reduce((sum, { header }) => sum + header.truth!.correct, 0);
  const known = judged.reduce((sum, { header }) => sum + header.truth!.objects.length, 0);
  const looked = pictures.length < of ? `${pictures.length} of ${of}` : of;
  return <span>{counted(found, "object")} in {looked} {of === 1 ? "frame" : "frames"}{known > 0 && `, ${correct} of ${known} correct`}</span>;
}

function Tile({ number }: { number: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const tile = tiles.value.get(number);
  const picture = typeof tile === "object" ? tile : undefined;
  const over = unfollowed.value;
  useEffect(() => {
    if (!canvas.current || !picture) return;
    const image = compose(picture, over, UNMARKED);
    canvas.current.width = image.width;
    canvas.current.height = image.height;
    canvas.current.getContext("2d")?.putImageData(image, 0, 0);
  }, [picture, over]);
  const name = greeting.value?.frames[number] ?? "";
  const truth = picture?.header.truth;
  const open = () => batch(() => {
    goTo(number);
    view.value = "picture";
  });
  return (
    <button class={number === frame.value ? "tile now" : "tile"} onClick={open} title={name}>
      {typeof tile === "string" ? <span class="refused">{tile}</span> : <canvas ref={canvas} aria-hidden="true" />}
      <span>
        {name.split("/").at(-1)}: {picture ? counted(picture.header.scene.objects.length, "object") : tile === undefined ? "…" : "no picture"}
        {truth ? `, ${truth.correct}/${truth.objects.length} correct` : ""}
      </span>
    </button>
  );
}
