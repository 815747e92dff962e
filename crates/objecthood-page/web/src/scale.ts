// Where the slider of a number goes: the range of a parameter is what it may be, which is often far more than what anybody tries.

import { Parameter } from "./wire";

export interface Scale {
  least: number;
  most: number;
  step: number;
}

/** The slider's range: all of the parameter's if it is at most ten times the default, else up to four times the default; the value in it. */
export function scaleOf({ limits, is_whole, default: written }: Parameter, value: number): Scale {
  const [low, high] = limits ?? [0, 1];
  const usual = Math.abs(Number(written));
  const isWide = usual > 0 && high > 10 * usual && high - low > 2;
  const most = Math.max(isWide ? 4 * usual : high, value);
  const least = Math.min(isWide ? (low < 0 ? -4 * usual : 0) : low, value);
  const step = nice((most - least) / 200);
  return { least: Math.floor(least / step) * step, most, step: is_whole ? Math.max(1, Math.round(step)) : step };
}

/** The number nearest to a place of the slider that is a multiple of its step and that the parameter takes. */
export function snapped(place: number, { step }: Scale, limits: [number, number]): number {
  const multiple = Number((Math.round(place / step) * step).toPrecision(6));
  return Math.min(Math.max(multiple, limits[0]), limits[1]);
}

/** 1, 2 or 5 times a power of ten, at most `step`. */
function nice(step: number): number {
  const power = 10 ** Math.floor(Math.log10(step));
  const digit = step / power;
  return Number(((digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power).toPrecision(3));
}
