// The settings in the forms of other programs, and in files.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { asCommand, asPython, asToml, fromToml } from "./copy";
import { complain, greeting, settings } from "./state";
import { wordsOf } from "./wire";

export const isOpen = signal(false);
const FORMS = { TOML: "a file for --config", "command line": "for a shell", Python: "for a program" };
/** How a file of each form is named. */
const FILES = { TOML: "objecthood.toml", "command line": "objecthood.sh", Python: "settings.py" };
type Form = keyof typeof FORMS;
const form = signal<Form>("TOML");
const copied = signal(false);

function text(): string {
  const about = greeting.value;
  if (!about) return "";
  if (form.value === "TOML") return asToml(settings.value);
  return form.value === "Python" ? asPython(settings.value) : asCommand(settings.value, about);
}

export function Elsewhere() {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (isOpen.value) dialog.current?.showModal();
    else dialog.current?.close();
    copied.value = false;
  }, [isOpen.value]);
  const now = text();
  return (
    <dialog ref={dialog} class="elsewhere" aria-label="Settings elsewhere" onClose={() => (isOpen.value = false)}>
      <div class="bar" role="tablist">
        {(Object.keys(FORMS) as Form[]).map((name) => (
          <button key={name} role="tab" aria-selected={form.value === name} onClick={() => { form.value = name; copied.value = false; }}>{name}</button>
        ))}
      </div>
      <p class="note">{FORMS[form.value]}</p>
      <textarea readOnly rows={10} value={now} aria-label={form.value} />
      <div class="bar">
        <button class="main" onClick={() => void copy(now)}>{copied.value ? "Copied" : "Copy"}</button>
        <button onClick={() => save(now)}>Save to a file</button>
        <label class="button">
          Load a TOML file
          <input type="file" accept=".toml,application/toml" class="unseen" onChange={(e) => void load(e.currentTarget)} />
        </label>
        <button onClick={() => (isOpen.value = false)}>Close</button>
      </div>
    </dialog>
  );
}

async function copy(what: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(what);
    copied.value = true;
  } catch {
    complain("the browser does not let the page copy: select the text and copy it");
  }
}

function save(what: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([what], { type: "text/plain" }));
  link.download = FILES[form.value];
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function load(input: HTMLInputElement): Promise<void> {
  const file = input.files?.[0];
  input.value = "";
  if (!file || !greeting.value) return;
  try {
    settings.value = fromToml(await file.text(), greeting.value);
    isOpen.value = false;
  } catch (error) {
    complain(`${file.name} holds no settings: ${wordsOf(error)}`);
  }
}
