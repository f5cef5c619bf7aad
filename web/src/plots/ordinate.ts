import type { Band, Line, Samples } from '../document';
import type { LineLook } from './frame';
import { lower_bound } from './gaps';

export type Range = [number, number];

/** A line of a panel with its abscissae and its look. */
export interface Drawn {
  line: Line;
  x: number[];
  spacing: number;
  band?: Band & { at: number[] };
  look: LineLook;
}

/** The range of a panel's ordinate, and the lines that leave it. */
export interface Ordinate {
  range: Range;
  off_scale: Set<Drawn>;
}

/** An estimate that leaves the measured range by more than this many times its height has failed: it sets no scale. */
const kFarHeights = 3;
/** Without a measurement, a line this many times higher than all others. */
const kFarLines = 100;

export function height_of([low, high]: Range): number {
  return high - low;
}

export function union_of(ranges: Range[]): Range {
  return [Math.min(...ranges.map((each) => each[0])), Math.max(...ranges.map((each) => each[1]))];
}

/** Smallest and largest value in sight; [Infinity, -Infinity] for none. */
export function extremes(x: number[], values: Samples[], from: number, to: number): Range {
  let low = Infinity;
  let high = -Infinity;
  // One sample more on either side: lines enter and leave the window.
  const first = Math.max(0, lower_bound(x, from) - 1);
  const last = Math.min(x.length, lower_bound(x, to) + 1);
  for (const series of values) {
    for (let k = first; k < last; ++k) {
      const value = series[k];
      if (value === null || value === undefined) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/**
 * Which of several ranges would stretch a common scale: judged by what was measured, or by the others where nothing was.
 * `measured` and `ranges` correspond.
 */
export function stretching(ranges: Range[], measured: boolean[]): boolean[] {
  const none = ranges.map(() => false);
  const seen = ranges.map(([low, high]) => low <= high);
  const trusted = ranges.filter((_, k) => seen[k] && measured[k]);
  if (trusted.length === 0) {
    const heights = ranges.filter((_, k) => seen[k]).map(height_of).sort((a, b) => b - a);
    const second = heights[1] ?? 0;
    return second > 0 ? ranges.map((range, k) => (seen[k] ?? false) && height_of(range) > kFarLines * second) : none;
  }
  const base = union_of(trusted);
  const others = ranges.filter((_, k) => seen[k] && !measured[k]).map(height_of).sort((a, b) => a - b);
  const typical = others.length > 2 ? (others[(others.length - 1) >> 1] ?? 0) : 0;
  // A steady measurement says little about how far an estimate may reasonably go.
  const height = Math.max(height_of(base), 0.1 * Math.max(Math.abs(base[0]), Math.abs(base[1])), typical);
  if (!(height > 0)) return none;
  const far = kFarHeights * height;
  return ranges.map(([low, high], k) => (seen[k] ?? false) && !measured[k] && (low < base[0] - far || high > base[1] + far));
}

/** The common range of those that do not stretch it, with some room towards those that do. */
export function kept_range(ranges: Range[], leaves: boolean[]): Range {
  const kept = union_of(ranges.filter((_, k) => !leaves[k]));
  if (!(kept[0] <= kept[1])) return kept;
  const room = 0.25 * (height_of(kept) > 0 ? height_of(kept) : Math.abs(kept[1]));
  const gone = ranges.filter((_, k) => leaves[k]);
  return [gone.some(([low]) => low < kept[0]) ? kept[0] - room : kept[0], gone.some(([, high]) => high > kept[1]) ? kept[1] + room : kept[1]];
}

/** Half the median width of a band in a window: what is typical, whatever the first seconds of a filter look like. */
function typical_half_width(band: Band & { at: number[] }, from: number, to: number): number {
  const widths: number[] = [];
  for (let k = lower_bound(band.at, from); k < band.at.length && (band.at[k] as number) <= to; ++k) {
    const low = band.low[k];
    const high = band.high[k];
    if (low !== null && low !== undefined && high !== null && high !== undefined) widths.push((high - low) / 2);
  }
  widths.sort((a, b) => a - b);
  return widths[widths.length >> 1] ?? 0;
}

/**
 * The ordinate for what is in sight: the lines entirely, the bands unless they would flatten the lines, and no line that
 * would flatten all others, unless `everything` is to be seen.
 */
export function ordinate_of(drawn: Drawn[], from: number, to: number, everything: boolean): Ordinate {
  const ranges = drawn.map(({ line, x }) => extremes(x, [line.y], from, to));
  const leaves = everything ? drawn.map(() => false) : stretching(ranges, drawn.map(({ line }) => line.role === 'measured'));
  let [low, high] = kept_range(ranges, leaves);
  let band_low = Infinity;
  let band_high = -Infinity;
  let typical = 0;
  drawn.forEach(({ band }, k) => {
    if (!band || leaves[k]) return;
    const [a, b] = extremes(band.at, [band.low, band.high], from, to);
    band_low = Math.min(band_low, a);
    band_high = Math.max(band_high, b);
    typical = Math.max(typical, typical_half_width(band, from, to));
  });
  if (!(low <= high)) [low, high] = band_low <= band_high ? [band_low, band_high] : [0, 1];
  const allowed = Math.max(0.6 * (high - low), 3 * typical);
  const bottom = Math.max(Math.min(low, band_low), low - allowed);
  const top = Math.min(Math.max(high, band_high), high + allowed);
  const margin = top > bottom ? 0.06 * (top - bottom) : Math.max(1e-3, 0.05 * Math.abs(top));
  return { range: [bottom - margin, top + margin], off_scale: new Set(drawn.filter((_, k) => leaves[k])) };
}
