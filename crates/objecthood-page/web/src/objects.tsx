// What was found: a list of objects, and what stands on what.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { colorOf } from "./paint";
import { pictures, selected } from "./state";
import { Picture, SceneObject } from "./wire";

type Column = "id" | "objectness" | "size_px" | "top_m";

const order = signal<{ by: Column; falls: boolean }>({ by: "id", falls: false });
const TITLES: Record<Column, string> = { id: "#", objectness: "objectness", size_px: "pixels", top_m: "top" };

export function Objects() {
  const picture = pictures[0].value;
  if (!picture) return null;
  const { objects, notices } = picture.header.scene;
  const { by, falls } = order.value;
  const value = (one: SceneObject) => one[by] ?? 0;
  const sorted = [...objects].sort((a, b) => (falls ? -1 : 1) * (value(a) - value(b)) || a.id - b.id);
  return (
    <section aria-label="Objects">
      <Score picture={picture} />
      {picture.header.paths && <p class="note">Found in this frame alone: these numbers are not those of the tracks.</p>}
      {notices.map((notice) => <p key={notice} class="note">{notice}</p>)}
      <table class="objects">
        <thead>
          <tr>
            <th scope="col"><span class="unseen">crop</span></th>
            {(Object.keys(TITLES) as Column[]).map((column) => (
              <th key={column} scope="col" aria-sort={by === column ? (falls ? "descending" : "ascending") : "none"}>
                <button class="quiet" onClick={() => (order.value = { by: column, falls: by === column ? !falls : column !== "id" })}>
                  {TITLES[column]}{by === column ? (falls ? " ▼" : " ▲") : ""}
                </button>
              </th>
            ))}
          </tr>
        </thead>
        <tbody>{sorted.map((one) => <Row key={one.id} object={one} picture={picture} />)}</tbody>
      </table>
      {objects.length === 0 && <p class="note">No object was found.</p>}
      <h3>What stands on what</h3>
      <Tree picture={picture} />
    </section>
  );
}

function choose(id: number): void {
  selected.value = selected.value === id ? null : id;
}

function Row({ object, picture }: { object: SceneObject; picture: Picture }) {
  const { id, objectness, parts, size_px, top_m } = object;
  const isChosen = selected.value === id;
  const row = useRef<HTMLTableRowElement>(null);
  useEffect(() => {
    if (isChosen) row.current?.scrollIntoView({ block: "nearest" });
  }, [isChosen]);
  const weakest = Object.entries(parts).sort((a, b) => a[1] - b[1]);
  return (
    <>
      <tr ref={row} class={isChosen ? "chosen" : ""} onClick={() => choose(id)}>
        <td><Crop object={object} picture={picture} /></td>
        <td>
          <button class="id" aria-pressed={isChosen} onClick={(e) => { e.stopPropagation(); choose(id); }} aria-label={`Object ${id}`}>
            <Swatch color={colorOf(picture, id)} />{id}
          </button>
        </td>
        <td><meter min={0} max={1} value={objectness} /> {objectness.toFixed(2)}</td>
        <td>{size_px}</td>
        <td>{top_m == null ? "" : `${(100 * top_m).toFixed(1)} cm`}</td>
      </tr>
      {isChosen && (
        <tr class="parts">
          <td colSpan={5}>
            {weakest.map(([name, part]) => <span key={name} class={part < 0.9 ? "weak" : ""}>{name} {part.toFixed(2)}</span>)}
            <span>{object.box_m.extents_m.map((side) => (100 * side).toFixed(1)).join(" × ")} cm</span>
            <span>{object.facets} facets</span>
          </td>
        </tr>
      )}
    </>
  );
}

export function Swatch({ color: [r, g, b] }: { color: [number, number, number] }) {
  return <i class="swatch" style={{ background: `rgb(${r}, ${g}, ${b})` }} />;
}

const CROP_PX = 44;

/** The object in the colour image, and a little around it. */
function Crop({ object, picture }: { object: SceneObject; picture: Picture }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const color = picture.maps.get("color");
  const { u, v, width, height } = object.box_px;
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context || !color) return;
    const image = context.createImageData(CROP_PX, CROP_PX);
    const side = 1.1 * Math.max(width, height);
    const [left, top] = [u + width / 2 - side / 2, v + height / 2 - side / 2];
    for (let y = 0; y < CROP_PX; y++) {
      for (let x = 0; x < CROP_PX; x++) {
        const [a, b] = [Math.floor(left + (side * x) / CROP_PX), Math.floor(top + (side * y) / CROP_PX)];
        if (a < 0 || b < 0 || a >= color.width || b >= color.height) continue;
        const from = 3 * (b * color.width + a);
        image.data.set([color.data[from], color.data[from + 1], color.data[from + 2], 255], 4 * (y * CROP_PX + x));
      }
    }
    context.putImageData(image, 0, 0);
  }, [color, u, v, width, height]);
  return color ? <canvas ref={canvas} class="crop" width={CROP_PX} height={CROP_PX} aria-hidden="true" /> : null;
}

/** How well it fits the truth, where that is known. */
function Score({ picture }: { picture: Picture }) {
  const { truth } = picture.header;
  if (!truth) return null;
  const wrong = truth.objects.filter(({ verdict }) => verdict !== "correct").map(({ verdict }) => verdict);
  return (
    <p class="score">
      <strong>{truth.correct} of {truth.objects.length} correct</strong>
      {wrong.length > 0 && ` (${wrong.join(", ")})`}, {truth.off_objects} of {truth.hypotheses} off objects
      {truth.overlap_f != null && `, overlap F ${(100 * truth.overlap_f).toFixed(1)}`}
    </p>
  );
}

/** A support with all that it carries; what has several supports appears below the surest. */
function Tree({ picture }: { picture: Picture }) {
  const { nodes, edges } = picture.header.scene.support;
  const best = new Map<number, (typeof edges)[number]>();
  for (const edge of edges) {
    const known = best.get(edge.upper);
    if (!known || edge.confidence > known.confidence) best.set(edge.upper, edge);
  }
  const above = new Map<number, number[]>();
  for (const [upper, { lower }] of best) above.set(lower, [...(above.get(lower) ?? []), upper]);
  const roots = nodes.map((_, k) => k).filter((k) => !best.has(k));
  const branch = (k: number, depth: number) => {
    const edge = best.get(k);
    const others = edges.filter((one) => one.upper === k && one !== edge).length;
    const { object, plane } = nodes[k];
    const name = object != null ? `object ${object}` : plane != null ? `surface ${plane + 1}` : "not an object";
    return (
      <li key={k}>
        {edge && <span class="kind">{edge.kind.replaceAll("_", " ")} {edge.confidence.toFixed(2)}{edge.hidden ? ", hidden" : ""}</span>}
        {object != null
          ? <button class="id" aria-pressed={selected.value === object} onClick={() => choose(object)}><Swatch color={colorOf(picture, object)} />{name}</button>
          : <span>{name} <small>{nodes[k].size_px} px</small></span>}
        {others > 0 && <small> and on {others} more</small>}
        {above.has(k) && depth < nodes.length && <ul>{above.get(k)!.map((upper) => branch(upper, depth + 1))}</ul>}
      </li>
    );
  };
  return <ul class="tree">{roots.map((k) => branch(k, 0))}</ul>;
}
