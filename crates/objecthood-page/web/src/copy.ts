// The settings in the forms in which other programs take them.

import { parse } from "smol-toml";

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

/** Settings out of a file for `--config`. */
export function fromToml(text: string, { parameters }: Greeting): Settings {
  const { method = "context", ...groups } = parse(text);
  if (method !== "context" && method !== "paper") throw new Error("its method is neither context nor paper");
  const set: Settings["set"] = {};
  for (const [group, its] of Object.entries(groups)) {
    if (typeof its !== "object") throw new Error(`${group} is no group of parameters`);
    for (const [parameter, value] of Object.entries(its)) {
      const name = `${group}.${parameter}`;
      if (!parameters.some((one) => one.name === name)) throw new Error(`there is no parameter ${name}`);
      if (!["number", "string", "boolean"].includes(typeof value)) throw new Error(`${name} is no single value`);
      set[name] = value as Value;
    }
  }
  return { method, set };
}

export function asPython({ method, set }: Settings): string {
  const lines = Object.keys(set).sort().map((name) => {
    const value = set[name];
    return `params.${name} = ${value === true ? "True" : value === false ? "False" : literal(value)}`;
  });
  return ["import objecthood", "", `params = objecthood.Params(method="${method}")`, ...lines, ""].join("\n");
}
