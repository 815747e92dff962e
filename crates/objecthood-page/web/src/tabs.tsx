// Tabs: one of several things is shown.

export function Tabs<T extends string>({ of, names, label }: { of: { value: string }; names: Partial<Record<T, string>>; label: string }) {
  return (
    <div class="tabs" role="tablist" aria-label={label}>
      {(Object.keys(names) as T[]).map((name) => (
        <button key={name} role="tab" aria-selected={of.value === name} onClick={() => (of.value = name)}>{names[name]}</button>
      ))}
    </div>
  );
}

/** The tab behind the present one. */
export function next<T extends string>(of: { value: string }, names: Record<T, string>): void {
  const all = Object.keys(names) as T[];
  of.value = all[(all.indexOf(of.value as T) + 1) % all.length];
}
