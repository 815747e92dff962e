// Every parameter of the method, below the stage that reads it first.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { rangeOf } from "./range";
import { scaleOf, snapped } from "./scale";
import { STAGES, stageOf } from "./stages";
import { defaultOf, greeting, pictures, set, settings, solo, valueOf } from "./state";
import { Parameter, Settings, Value } from "./wire";

const sought = signal("");
const onlyChanged = signal(false);
/** The parameter that is pointed out. */
const revealed = signal<string | null>(null);
const REVEALED_MS = 2500;
/** What was typed and is not allowed, while the settings are those. */
const refused = signal<{ name: string; typed: number; by: Settings } | null>(null);

/** Scrolls to a parameter and marks it for a moment, whatever hides it. */
export function reveal(name: string): void {
  if (!fits(name)) [sought.value, onlyChanged.value] = ["", false];
  revealed.value = null;
  setTimeout(() => (revealed.value = name));
  setTimeout(() => revealed.value === name && (revealed.value = null), REVEALED_MS);
}

/** Whether the search box lets a parameter through. */
function fits(name: string): boolean {
  const parameter = greeting.value?.parameters.find((one) => one.name === name);
  const text = `${name} ${parameter?.meaning ?? ""}`.toLowerCase();
  const words = sought.value.toLowerCase().split(/\s+/);
  return words.every((word) => text.includes(word)) && (!onlyChanged.value || name in settings.value.set);
}

export function Parameters() {
  const { method } = settings.value;
  const all = (greeting.value?.parameters ?? []).filter((one) => stageOf(one, method) !== null);
  const shown = all.filter((one) => fits(one.name));
  const changed = Object.keys(settings.value.set).length;
  return (
    <section class="parameters" aria-label="Parameters">
      <div class="bar">
        <label>
          Method{" "}
          <select
            value={method}
            onChange={(e) => (settings.value = { ...settings.value, method: e.currentTarget.value as typeof method })}
          >
            <option value="context">context</option>
            <option value="paper">paper</option>
          </select>
        </label>
        <button disabled={changed === 0} onClick={() => (settings.value = { method, set: {} })}>Reset all {changed || ""}</button>
      </div>
      <div class="bar">
        <input
          id="sought" type="search" placeholder="Find a parameter" aria-label="Find a parameter" value={sought.value}
          onInput={(e) => (sought.value = e.currentTarget.value)}
        />
        <label>
          <input type="checkbox" checked={onlyChanged.value} onChange={(e) => (onlyChanged.value = e.currentTarget.checked)} />
          {" "}changed
        </label>
      </div>
      <div class="groups">
        {STAGES.map(({ stage, title, layer }) => {
          const its = shown.filter((one) => stageOf(one, method) === stage);
          if (its.length === 0) return null;
          return (
            <section key={stage} class="group">
              <header>
                <h3>{title}</h3>
                <Lap stage={stage} />
                <button class="quiet" title={`Show only the layer of this stage: ${layer}`} onClick={() => solo(layer)}>show</button>
              </header>
              {its.map((one) => <Row key={one.name} parameter={one} />)}
            </section>
          );
        })}
        {shown.length === 0 && <p class="note">No parameter fits.</p>}
      </div>
    </section>
  );
}

/** How long the stage took last time. */
function Lap({ stage }: { stage: string }) {
  const lap = pictures[0].value?.header.stages_ms.find(([name]) => name === stage);
  return <span class="lap" title="Time of this stage, last time; 0.0 = was not run again">{lap ? `${lap[1].toFixed(1)} ms` : ""}</span>;
}

/** What a parameter means; the names in it stand between backticks. */
function Meaning({ text }: { text: string }) {
  return <>{text.split("`").map((part, k) => (k % 2 ? <code key={k}>{part}</code> : part))}</>;
}

function Row({ parameter }: { parameter: Parameter }) {
  const { name, meaning, range, source } = parameter;
  const value = valueOf(name);
  const isChanged = name in settings.value.set;
  const id = `p-${name}`;
  const isRevealed = revealed.value === name;
  const whole = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (isRevealed) whole.current?.scrollIntoView({ block: "center" });
  }, [isRevealed]);
  return (
    <div ref={whole} class={`parameter${isChanged ? " changed" : ""}${isRevealed ? " revealed" : ""}`}>
      <div class="name">
        <label for={id} title={`${name}\nrange ${range}\n${source}`}>
          {isChanged && <span class="mark" role="img" aria-label="changed">●</span>}{breakable(name)}
        </label>
        <button class="quiet" disabled={!isChanged} aria-label={`Reset ${name}`} onClick={() => set(name, undefined)}>reset</button>
      </div>
      {value === undefined ? null : parameter.limits ? <NumberOf parameter={parameter} id={id} value={Number(value)} />
        : <Choice parameter={parameter} id={id} value={value} />}
      {refused.value?.name === name && refused.value.by === settings.value && (
        <p class="refused" role="alert">
          {refused.value.typed} is not allowed: {parameter.is_whole ? "whole numbers from" : "from"} {parameter.limits?.[0]} to {parameter.limits?.[1]}.
          It stays at {String(value)}.
        </p>
      )}
      <p class="meaning" id={`${id}-meaning`}>
        <Meaning text={meaning} /> <span class="range">{rangeOf(parameter)}</span>
      </p>
    </div>
  );
}

/** A long name may go on in the next line behind a point or an underscore. */
export function breakable(name: string) {
  return name.split(/(?<=[._])/).map((part, k) => [k > 0 && <wbr />, part]);
}

interface Control<T> {
  parameter: Parameter;
  id: string;
  value: T;
}

function NumberOf({ parameter, id, value }: Control<number>) {
  const limits = parameter.limits ?? [0, 1];
  const scale = scaleOf(parameter, value);
  return (
    <div class="control">
      <input
        type="range" aria-label={parameter.name} aria-describedby={`${id}-meaning`} tabIndex={0}
        min={scale.least} max={scale.most} step={scale.step} value={value}
        onInput={(e) => set(parameter.name, snapped(e.currentTarget.valueAsNumber, scale, limits))}
      />
      <input
        id={id} type="number" min={limits[0]} max={limits[1]} step={parameter.is_whole ? 1 : "any"} value={value}
        onChange={(e) => {
          const typed = e.currentTarget.valueAsNumber;
          const isAllowed = typed >= limits[0] && typed <= limits[1] && (!parameter.is_whole || Number.isInteger(typed));
          refused.value = isAllowed || !Number.isFinite(typed) ? null : { name: parameter.name, typed, by: settings.value };
          if (isAllowed) set(parameter.name, typed);
          else e.currentTarget.value = String(value);
        }}
      />
      <span class="unit">{parameter.unit.split(/[:;,(]| at /)[0].replace("dimensionless", "")}</span>
    </div>
  );
}

function Choice({ parameter, id, value }: Control<Value>) {
  const isSwitch = typeof defaultOf(parameter.name) === "boolean";
  if (isSwitch) {
    return <input id={id} type="checkbox" checked={value === true} onChange={(e) => set(parameter.name, e.currentTarget.checked)} />;
  }
  return (
    <select id={id} value={String(value)} onChange={(e) => set(parameter.name, e.currentTarget.value)}>
      {parameter.choices.map((choice) => <option key={choice} value={choice}>{choice}</option>)}
    </select>
  );
}
