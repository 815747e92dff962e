// What happens in a video: a timeline under the picture, and the events and tracks beside it.

import { Swatch } from "./objects";
import { objectColor } from "./paint";
import { frame, goTo, greeting } from "./state";
import { Film } from "./wire";

/** The frame that shows a moment: the last one until then. */
function frameAt({ stamps_s }: Film, time_s: number): number {
  const after = stamps_s.findIndex((stamp) => stamp > time_s + 1e-6);
  return after < 0 ? stamps_s.length - 1 : Math.max(after - 1, 0);
}

function span({ stamps_s, lives, happenings }: Film): [number, number] {
  const seen = Object.values(lives).flatMap(({ first_s, last_s }) => [first_s, last_s]);
  const times = [...stamps_s, ...seen, ...happenings.map(({ time_s }) => time_s)];
  const [first, last] = [Math.min(...times), Math.max(...times)];
  return [first, Math.max(last - first, 1e-6)];
}

export function Timeline({ film }: { film: Film }) {
  const [first] = span(film);
  const last = Math.max((greeting.value?.frames.length ?? 1) - 1, 1);
  // Below the place of the scrubber that shows it.
  const place = (time_s: number) => {
    const k = frameAt(film, time_s);
    const [from, to] = [film.stamps_s[k], film.stamps_s[k + 1]];
    const part = to > from ? Math.min(Math.max((time_s - from) / (to - from), 0), 1) : 0;
    return `${(100 * (k + part)) / last}%`;
  };
  const now = film.stamps_s[frame.value] ?? first;
  return (
    <div class="timeline" role="group" aria-label="Events">
      <i class="now" style={{ left: place(now) }} />
      {film.happenings.map(({ time_s, text }, k) => (
        <button key={k} style={{ left: place(time_s) }} title={`${(time_s - first).toFixed(2)} s: ${text}`} aria-label={text} onClick={() => goTo(frameAt(film, time_s))} />
      ))}
    </div>
  );
}

export function Story({ film }: { film: Film }) {
  const [first, length] = span(film);
  const now = film.stamps_s[frame.value] ?? first;
  return (
    <section aria-label="What happened">
      <h3>What happened</h3>
      {film.happenings.length === 0 && <p class="note">Nothing.</p>}
      <table class="objects">
        <tbody>
          {film.happenings.map(({ time_s, track, text }, k) => (
            <tr key={k} class={frameAt(film, time_s) === frame.value ? "chosen" : ""} onClick={() => goTo(frameAt(film, time_s))}>
              <td>{(time_s - first).toFixed(2)} s</td>
              <td class="told"><button class="quiet" onClick={() => goTo(frameAt(film, time_s))}><Swatch color={objectColor(track)} />{text}</button></td>
            </tr>
          ))}
        </tbody>
      </table>
      <h3>Tracks</h3>
      <table class="objects lives">
        <tbody>
          {Object.entries(film.lives).map(([track, { first_s, last_s }]) => (
            <tr key={track} onClick={() => goTo(frameAt(film, first_s))}>
              <td><button class="quiet" onClick={() => goTo(frameAt(film, first_s))}><Swatch color={objectColor(Number(track))} />{track}</button></td>
              <td class="life">
                <i style={{ left: `${(100 * (first_s - first)) / length}%`, width: `${(100 * (last_s - first_s)) / length}%` }} />
                <b style={{ left: `${(100 * (now - first)) / length}%` }} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
