// The settings in the forms in which other programs take them.

import { Greeting, Settings, Value } from "./wire";

function literal(value: Value): string {
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

export function asToml({ method, set }: Settings): string {
  let text = `method = "${method}"\n`;
  let group = "";
  for (const name of Object.keys(set).sort()) {
    const [its, parameter] = name.split(".");
    if (its !== group) text += `\n[${(group = its)}]\n`;
    text += `${parameter} = ${literal(set[name])}\n`;
  }
  return text;
}

export function asCommand({ method, set }: Settings, { words }: Greeting): string {
  const changes = Object.keys(set).sort().map((name) => ` --set ${name}=${set[name]}`).join("");
  // Frames that come by stdin are answered on stdout.
  const out = words[0] === "-" ? "" : " --out found";
  return `objecthood segment ${words.join(" ")}${out} --method ${method}${changes}`;
}

export function asJson(settings: Settings): string {
  return `${JSON.stringify(settings, null, 2)}\n`;
}

/** Settings out of a file that this page saved. */
export function fromJson(text: string, { parameters }: Greeting): Settings {
  const read = JSON.parse(text) as Partial<Settings>;
  if (read.method !== "context" && read.method !== "paper") throw new Error("the file names no method");
  const known = new Set(parameters.map(({ name }) => name));
  const unknown = Object.keys(read.set ?? {}).find((name) => !known.has(name));
  if (unknown) throw new Error(`there is no parameter ${unknown}`);
  return { method: read.method, set: { ...read.set } };
}

export function asPython({ method, set }: Settings): string {
  const lines = Object.keys(set).sort().map((name) => {
    const value = set[name];
    return `params.${name} = ${value === true ? "True" : value === false ? "False" : literal(value)}`;
  });
  return ["import objecthood", "", `params = objecthood.Params(method="${method}")`, ...lines, ""].join("\n");
}
